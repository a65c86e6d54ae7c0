//! Prediction: the values of a given policy, estimated from episodes (Sutton & Barto, 2nd ed., chapters 5 to 7, 9, 11 and
//! 12). One method per file.

mod batch_td;
mod episode;
mod fixed_policy;
mod linear_values;
mod lstd;
mod n_step_td;
mod off_policy;
mod offline_lambda_return;
mod policy_task;
mod predictor;
mod state_features;
mod td_zero;
#[cfg(test)]
mod test_support;
mod traces;

pub use batch_td::BatchTd;
pub use fixed_policy::FixedPolicy;
pub use linear_values::LinearValues;
pub use lstd::Lstd;
pub use n_step_td::NStepTd;
pub use off_policy::{EmphaticTd, GradientTd, GradientTdKind, ImportanceSampling, OffPolicyTd};
pub use offline_lambda_return::OfflineLambdaReturn;
pub use policy_task::{ActionFromTask, ObservableTask, ObservationPolicy, PolicyTask, WithAction};
pub use predictor::{Behavior, PredictionRule, PredictionStep, Predictor};
pub use state_features::StateFeatures;
pub use td_zero::TdZero;
pub use traces::{TdLambda, TrueOnlineTdLambda};
