//! Prediction: the values of a given policy, estimated from episodes (Sutton & Barto, 2nd ed., chapters 5 to 7, 9 and
//! 12). One method per file.

mod batch_td;
mod behavior;
mod episode;
mod fixed_policy;
mod importance_sampling;
mod linear_values;
mod monte_carlo;
mod n_step_td;
mod observed;
mod offline_lambda_return;
mod policy_task;
mod prediction_rule;
mod predictor;
mod row_sets;
mod state_rows;
mod td_lambda;
mod td_zero;
#[cfg(test)]
mod test_support;
mod true_online_td_lambda;
mod visit_rows;

pub use batch_td::BatchTd;
pub use behavior::{Behavior, FromTask};
pub use fixed_policy::FixedPolicy;
pub use importance_sampling::{ImportanceSampling, Ratios};
pub use linear_values::LinearValues;
pub use monte_carlo::MonteCarloPrediction;
pub use n_step_td::NStepTd;
pub use observed::{Choice, Observed};
pub use offline_lambda_return::OfflineLambdaReturn;
pub use policy_task::{ObservableTask, ObservationPolicy, PolicyTask};
pub use prediction_rule::{PredictionRule, PredictionStep};
pub use predictor::Predictor;
pub use row_sets::RowSets;
pub use state_rows::StateRows;
pub use td_lambda::TdLambda;
pub use td_zero::TdZero;
pub use true_online_td_lambda::TrueOnlineTdLambda;
pub use visit_rows::VisitRows;
