//! Prediction: the values of a given policy, estimated from episodes (Sutton & Barto, 2nd ed., chapters 5 to 7, 9 and
//! 12). One method per file.

mod batch_td;
mod episode;
mod fixed_policy;
mod importance_sampling;
mod linear_values;
mod n_step_td;
mod offline_lambda_return;
mod policy_task;
mod predictor;
mod state_features;
mod td_lambda;
mod td_zero;
#[cfg(test)]
mod test_support;
mod traces;
mod true_online_td_lambda;

pub use batch_td::BatchTd;
pub use fixed_policy::FixedPolicy;
pub use importance_sampling::ImportanceSampling;
pub use linear_values::LinearValues;
pub use n_step_td::NStepTd;
pub use offline_lambda_return::OfflineLambdaReturn;
pub use policy_task::{ActionFromTask, ObservableTask, ObservationPolicy, PolicyTask, WithAction};
pub use predictor::{Behavior, PredictionRule, PredictionStep, Predictor};
pub use state_features::StateFeatures;
pub use td_lambda::TdLambda;
pub use td_zero::TdZero;
pub use true_online_td_lambda::TrueOnlineTdLambda;
