//! Conversions from Python values to Rust values.

mod actions;
mod arrays;
mod numbers;
mod observation;
mod seed;
mod state_array;

pub(crate) use actions::{LARGEST_FORCE, box_action, discrete_action, first_item, numbered_action};
pub(crate) use arrays::{FromNumber, array_from, array_of, floats, in_c_order, integers, rows_array, small_array};
pub(crate) use numbers::{constant, double, numpy_scalar};
pub(crate) use observation::{BoxReader, DiscreteReader, ObservationReader};
pub(crate) use seed::{Seed, Seeds};
pub(crate) use state_array::StateArray;
