//! The learning algorithms, grouped by the experience that they learn from. Shared parts are in `common`.

mod any_algorithm;
mod any_learner;
mod common;
mod models;
mod monte_carlo;
mod n_step;
mod one_step;
mod policy_gradient;
mod traces;

pub use any_algorithm::{AnyAlgorithm, FeatureKinds};
pub use any_learner::{AnyLearner, LearnerVisitor};
pub(crate) use common::StepInParts;
#[cfg(test)]
use common::test_support;
pub use common::{ActionMasks, Agent, CountBonus, Learner, TdLearner, TransformedSteps, UpdateRule};
use common::{MAX_WORK_PER_CALL, VALUES_PER_WORK, learn_borrowed, masked_values, row_work};
use models::single_row;
pub use models::{DynaModel, DynaQ, DynaQPlus, Model, ModelEntry, PrioritizedSweeping, StochasticModel};
pub use monte_carlo::{MonteCarloControl, OffPolicyMonteCarlo};
pub use n_step::{
    NStep, NStepMethod, NStepQSigma, NStepReturn, NStepSarsa, NStepTreeBackup, NStepVisit, QSigma, TargetPolicy,
    TreeBackup,
};
pub use one_step::{
    DifferentialQLearning, DifferentialSarsa, DoubleQLearning, ExpectedSarsa, GradientBandit, QLearning, Sarsa,
};
pub use policy_gradient::{ActorCritic, ActorCriticLambda, Critic, Reinforce};
pub use traces::{SarsaLambda, TraceKind, TraceOptions, Traces, TrueOnlineSarsaLambda, WatkinsQLambda};
