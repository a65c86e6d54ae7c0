//! The environments, one per file, in folders by Gymnasium's families.

pub mod classic_control;
mod env;
mod parameters;
mod simd_env;
pub mod tabular;
pub mod toy_text;
pub mod wrappers;

pub use env::{Env, Step, TransitionProbability};
use parameters::parameters;
pub use parameters::{Flag, Parameters};
pub use simd_env::SimdEnv;
