//! Prediction: the values of a given policy, estimated with many seeds at once.

mod box_features;
mod estimate;
mod function_policy;
mod observation_policy;
mod spec;

pub(crate) use box_features::BoxFeatures;
pub(crate) use estimate::estimate_values;
pub(crate) use spec::{ObservedVisitor, PredictionSpec};
