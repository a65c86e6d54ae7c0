//! An algorithm chosen at run time, and the learner that it makes of an agent.

use super::{
    Agent, DoubleQLearning, DynaQ, DynaQPlus, ExpectedSarsa, Learner, Model, NStepSarsa, QLearning, Sarsa, SarsaLambda,
    TdLearner, TraceKind, Traces, TrueOnlineSarsaLambda, UpdateRule, WatkinsQLambda,
};
use crate::features::ActiveRows;
use crate::memory::AllocationError;
use crate::{QTable, StopFlag};

/// One of the algorithms with its options.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnyAlgorithm {
    /// [`QLearning`]
    QLearning,
    /// [`Sarsa`]
    Sarsa,
    /// [`ExpectedSarsa`]
    ExpectedSarsa,
    /// [`DoubleQLearning`]
    DoubleQLearning,
    /// [`NStepSarsa`]
    NStepSarsa {
        /// The number of rewards in a target, at least 1.
        n_steps: usize,
    },
    /// [`SarsaLambda`]
    SarsaLambda(TraceOptions),
    /// [`TrueOnlineSarsaLambda`]
    TrueOnlineSarsaLambda {
        /// The trace decay λ.
        trace_decay: f64,
        /// Traces at or below this are dropped.
        trace_cutoff: f64,
    },
    /// [`WatkinsQLambda`]
    WatkinsQLambda(TraceOptions),
    /// [`DynaQ`]
    DynaQ {
        /// The updates from the model after each step.
        planning_steps: u32,
    },
    /// [`DynaQPlus`]
    DynaQPlus {
        /// The updates from the model after each step.
        planning_steps: u32,
        /// The weight κ of the bonus for actions not tried for long.
        time_weight: f64,
    },
}

/// The options of an algorithm whose eligibility traces are of a kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TraceOptions {
    /// What a visit does to a trace.
    pub kind: TraceKind,
    /// The trace decay λ.
    pub decay: f64,
    /// Traces at or below this are dropped.
    pub cutoff: f64,
}

/// What is done with the learner that [`AnyAlgorithm::learner`] makes, whichever its type.
pub trait LearnerVisitor<R> {
    /// The result.
    type Output;

    /// Takes the learner.
    fn visit<L: Learner<R> + Send + 'static>(self, learner: L) -> Self::Output;
}

impl AnyAlgorithm {
    /// How many tables the algorithm learns.
    pub fn n_tables(&self) -> usize {
        if matches!(self, Self::DoubleQLearning) { 2 } else { 1 }
    }

    /// Whether the algorithm learns a model, for which each state must have a row of the table.
    pub fn needs_single_rows(&self) -> bool {
        matches!(self, Self::DynaQ { .. } | Self::DynaQPlus { .. })
    }

    /// Makes a learner of an agent and passes it to `visitor`. `second_table` is the other table of Double Q-learning.
    /// `None` where the algorithm needs single rows and `R` holds several, or a second table and there is none.
    ///
    /// # Errors
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    pub fn learner<R, V>(
        self,
        agent: Agent,
        second_table: Option<QTable>,
        stop: &StopFlag<'_>,
        visitor: V,
    ) -> Result<Option<V::Output>, AllocationError>
    where
        R: ActiveRows + Send + 'static,
        V: LearnerVisitor<R>,
    {
        // Known when this is compiled, so that Dyna is left out of the code for several rows.
        if self.needs_single_rows() && size_of::<R>() != size_of::<u32>() {
            return Ok(None);
        }
        let (n_rows, num_actions) = agent.table.shape();
        let new_model = || Model::new(n_rows, num_actions, stop);
        let new_traces = |cutoff: f64| Traces::new(n_rows * num_actions, cutoff, stop);
        Ok(Some(match self {
            Self::QLearning => with_rule(agent, QLearning, visitor),
            Self::Sarsa => with_rule(agent, Sarsa, visitor),
            Self::ExpectedSarsa => with_rule(agent, ExpectedSarsa, visitor),
            Self::DoubleQLearning => match second_table {
                Some(second_table) => visitor.visit(DoubleQLearning::new(agent, second_table)),
                None => return Ok(None),
            },
            Self::NStepSarsa { n_steps } => with_rule(agent, NStepSarsa::new(n_steps), visitor),
            Self::SarsaLambda(TraceOptions { kind, decay, cutoff }) => {
                with_rule(agent, SarsaLambda { traces: new_traces(cutoff)?, kind, trace_decay: decay }, visitor)
            }
            Self::TrueOnlineSarsaLambda { trace_decay, trace_cutoff } => {
                with_rule(agent, TrueOnlineSarsaLambda::new(new_traces(trace_cutoff)?, trace_decay), visitor)
            }
            Self::WatkinsQLambda(TraceOptions { kind, decay, cutoff }) => {
                with_rule(agent, WatkinsQLambda { traces: new_traces(cutoff)?, kind, trace_decay: decay }, visitor)
            }
            Self::DynaQ { planning_steps } => with_rule(agent, DynaQ::new(new_model()?, planning_steps), visitor),
            Self::DynaQPlus { planning_steps, time_weight } => {
                with_rule(agent, DynaQPlus::new(new_model()?, planning_steps, time_weight, stop)?, visitor)
            }
        }))
    }
}

fn with_rule<R, U, V>(agent: Agent, rule: U, visitor: V) -> V::Output
where
    R: ActiveRows + Send + 'static,
    U: UpdateRule<R, Agent> + Send + 'static,
    V: LearnerVisitor<R>,
{
    visitor.visit(TdLearner { agent, rule })
}
