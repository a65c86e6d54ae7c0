//! The environments that Rust steps, and their registry.
//!
//! To add an environment, implement [`NativeEnv`] for it ([`classic_control::ClassicEnv`] provides an implementation
//! for environments with Gymnasium-style parameters), and add a line to the registry.

mod book;
mod classic_control;
mod external;
mod gymnasium;
mod native_env;
mod py_classic_control;
mod py_vector_env;
mod registry;
mod toy_text;

pub(crate) use classic_control::{numpy_uses_libm, step_cart_poles};
pub(crate) use external::{PyExternalEnv, PyExternalEpisode};
pub(crate) use native_env::{NativeEnv, PyNativeEnv};
pub(crate) use py_classic_control::{PyClassicControl, matches_numpy, parameter_names};
pub(crate) use py_vector_env::PyVectorEnv;
pub(crate) use toy_text::{PyBlackjack, PyTaxi, PyToyText, PyTransitionTable};
