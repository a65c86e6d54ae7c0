//! The specs of predictions: the values of given policies, estimated by a method.

mod action_values;
mod box_features;
mod method;
mod observation_policy;
mod policy_features;
mod py_observation;
mod spec;

pub(crate) use box_features::BoxFeatures;
pub(crate) use policy_features::{PolicyFeatures, ReadValues};
pub(crate) use spec::PredictionSpec;
