//! Prediction: the values of a given policy, estimated with many seeds at once.

mod estimate;
mod spec;

pub(crate) use estimate::estimate_values;
pub(crate) use spec::PredictionSpec;
