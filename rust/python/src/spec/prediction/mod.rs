//! The specs of predictions: the values of given policies, estimated by a method.

mod box_features;
mod method;
mod observation_policy;
mod py_observation;
mod spec;

pub(crate) use box_features::{BoxFeatures, ReadRows};
pub(crate) use spec::PredictionSpec;
