//! The learners of the algorithms that the page offers.
//!
//! The core's `AnyLearner` would link the learners of all algorithms, of which the page offers ten, and hides what an
//! inspection reads: traces, the second table, the logs of the learning rates. A page must load this module, so it stays
//! small.

pub(crate) mod greedy;

use qtab_core::features::ActiveRows;
use qtab_core::learners::{
    Agent, AnyAlgorithm, DoubleQLearning, DynaQ, DynaQPlus, ExpectedSarsa, Model, NStepSarsa, QLearning, Sarsa,
    SarsaLambda, TdLearner, TraceOptions, Traces, TrueOnlineSarsaLambda, WatkinsQLambda,
};
use qtab_core::{Learner, QTable, StopFlag, delegate_learner};

use crate::failure::Failure;

/// One of the learners for states with active rows `R`.
pub(crate) enum AnyLearner<R: ActiveRows> {
    QLearning(TdLearner<QLearning>),
    Sarsa(TdLearner<Sarsa>),
    ExpectedSarsa(TdLearner<ExpectedSarsa>),
    DoubleQLearning(TdLearner<DoubleQLearning>),
    NStepSarsa(TdLearner<NStepSarsa<R>>),
    SarsaLambda(TdLearner<SarsaLambda>),
    TrueOnlineSarsaLambda(TdLearner<TrueOnlineSarsaLambda>),
    WatkinsQLambda(TdLearner<WatkinsQLambda>),
    DynaQ(TdLearner<DynaQ>),
    DynaQPlus(TdLearner<DynaQPlus>),
}

impl<R: ActiveRows> AnyLearner<R> {
    /// The learner of an algorithm that learns with an agent, for a table with this many rows and actions;
    /// `second_table` is the other table of Double Q-learning.
    pub(crate) fn new(
        algorithm: AnyAlgorithm,
        (n_rows, num_actions): (usize, usize),
        agent: Agent,
        second_table: Option<QTable>,
        stop: &StopFlag<'_>,
    ) -> Result<Self, Failure> {
        if algorithm.needs_single_rows() && size_of::<R>() != size_of::<u32>() {
            return Err("algorithm must be one without a model for several active rows".into());
        }
        let new_model = || Model::new(n_rows, num_actions, stop);
        // Weighted features need no places for sparse traces.
        let places = if R::WEIGHTED { 0 } else { n_rows * num_actions };
        let new_traces = |cutoff: f64| Traces::new(places, cutoff, stop);
        Ok(match algorithm {
            AnyAlgorithm::QLearning => Self::QLearning(TdLearner { agent, rule: QLearning }),
            AnyAlgorithm::Sarsa => Self::Sarsa(TdLearner { agent, rule: Sarsa }),
            AnyAlgorithm::ExpectedSarsa => Self::ExpectedSarsa(TdLearner { agent, rule: ExpectedSarsa }),
            AnyAlgorithm::DoubleQLearning => {
                let second_table = second_table.ok_or("algorithm must have a second table")?;
                let rule = DoubleQLearning::new(agent.learning_rate.clone(), second_table);
                Self::DoubleQLearning(TdLearner { agent, rule })
            }
            AnyAlgorithm::NStepSarsa { n_steps } => {
                Self::NStepSarsa(TdLearner { agent, rule: NStepSarsa::new(n_steps) })
            }
            AnyAlgorithm::SarsaLambda(TraceOptions { kind, decay, cutoff }) => {
                let rule = SarsaLambda { traces: new_traces(cutoff)?, kind, trace_decay: decay };
                Self::SarsaLambda(TdLearner { agent, rule })
            }
            AnyAlgorithm::TrueOnlineSarsaLambda { trace_decay, trace_cutoff } => {
                let rule = TrueOnlineSarsaLambda::new(new_traces(trace_cutoff)?, trace_decay);
                Self::TrueOnlineSarsaLambda(TdLearner { agent, rule })
            }
            AnyAlgorithm::WatkinsQLambda(TraceOptions { kind, decay, cutoff }) => {
                let rule = WatkinsQLambda { traces: new_traces(cutoff)?, kind, trace_decay: decay };
                Self::WatkinsQLambda(TdLearner { agent, rule })
            }
            AnyAlgorithm::DynaQ { planning_steps } => {
                Self::DynaQ(TdLearner { agent, rule: DynaQ::new(new_model()?, planning_steps) })
            }
            AnyAlgorithm::DynaQPlus { planning_steps, time_weight } => {
                let rule = DynaQPlus::new(new_model()?, planning_steps, time_weight, stop)?;
                Self::DynaQPlus(TdLearner { agent, rule })
            }
            _ => return Err("algorithm must be one of the playground's".into()),
        })
    }
}

impl<R: ActiveRows> Learner<R> for AnyLearner<R> {
    delegate_learner!(
        all R, learner in
        Self::QLearning(learner),
        Self::Sarsa(learner),
        Self::ExpectedSarsa(learner),
        Self::DoubleQLearning(learner),
        Self::NStepSarsa(learner),
        Self::SarsaLambda(learner),
        Self::TrueOnlineSarsaLambda(learner),
        Self::WatkinsQLambda(learner),
        Self::DynaQ(learner),
        Self::DynaQPlus(learner)
    );
}
