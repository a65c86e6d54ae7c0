//! Environments for qtab as shared libraries: the C interface `qtab_env.h` for Rust.
//!
//! An environment implements [`Env`], and [`export_env!`] exports it from a `cdylib`, which `qtab.NativeEnv` loads:
//!
//! ```
//! use qtab_env::{Env, Generator, Step};
//!
//! /// A walk on the numbers from 0 to 6 that starts in the middle; the right end gives a reward of 1.
//! struct Walk;
//!
//! impl Env for Walk {
//!     type State = i64;
//!     type Number = i64;
//!
//!     fn num_actions(&self) -> usize {
//!         2
//!     }
//!
//!     fn observation_bounds(&self) -> Vec<(i64, i64)> {
//!         vec![(0, 6)]
//!     }
//!
//!     fn reset(&self, _rng: &mut Generator<'_>) -> i64 {
//!         3
//!     }
//!
//!     fn step(&self, state: &i64, action: usize, rng: &mut Generator<'_>) -> Step<i64> {
//!         let forward = rng.random() < if action == 1 { 0.9 } else { 0.1 };
//!         let state = if forward { state + 1 } else { state - 1 };
//!         Step::new(state, f64::from(u8::from(state == 6)), state == 0 || state == 6)
//!     }
//!
//!     fn observe(&self, state: &i64, observation: &mut [i64]) {
//!         observation[0] = *state;
//!     }
//! }
//!
//! qtab_env::export_env!(Walk);
//! # fn main() {}
//! ```
//!
//! [`host`] is the other side: it checks an environment that another library exports, and calls its functions.
//!
//! This crate has all `unsafe` code of the interface. Each block states why it is sound.

mod env;
mod export;
mod generator;
pub mod host;
mod number;
mod table;

pub use env::{Env, Step};
#[doc(hidden)]
pub use export::Exported;
pub use generator::Generator;
pub use number::Number;
pub use table::{
    ALIGNMENT, Bitgen, CONTINUES, ENV_VERSION, FAILED, FLOAT32, FLOAT64, INT64, ObserveFunction, ResetFunction,
    StepFunction, TERMINATED, TRUNCATED, Table,
};

/// The code of the README compiles.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
