//! What a run estimates instead of learning to act: the values of given policies, by a method.

mod box_features;
mod observation_policy;
mod spec;

pub(crate) use box_features::BoxFeatures;
pub(crate) use spec::PredictionSpec;
