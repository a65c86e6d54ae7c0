//! The terms of a step's target, for each algorithm.

use qtab_core::features::ActiveRows;
use qtab_core::learners::{Agent, TraceKind, Traces};
use qtab_core::schedules::{LearningRate, StepSize};
use qtab_core::tasks::Next;

use crate::learners::AnyLearner;
use crate::updates::{StepEnd, Update, UpdateKind};

/// The value of the next state, before the step.
enum NextValue {
    /// None: the next state is terminal for the learner, or the target spans more than this step.
    None,
    One(f64),
    /// One value for each action, chosen by the next action.
    OfAction(Vec<f64>),
    /// One value for each table, chosen by the table that is updated.
    OfTable([f64; 2]),
}

/// The numbers of a step before the learner learns from it.
pub(crate) struct StepTerms<R> {
    state: R,
    action: usize,
    reward: f64,
    end: StepEnd,
    next: NextValue,
    old: f64,
    /// With traces: the traces of the active rows after this visit. Dutch traces are known only after the step.
    traces: Vec<f64>,
    q_old: Option<f64>,
    /// [`weighted_rate`] of the state.
    pub(super) weighted_rate: Option<f64>,
}

/// With weighted features, how much of an error an update corrects: it moves weight i by αᵢ xᵢ times the error, and so the
/// value by Σᵢ αᵢ xᵢ² times the error. `None` for binary features.
pub(super) fn weighted_rate<R: ActiveRows>(learner: &mut AnyLearner<R>, state: &R) -> Option<f64> {
    let rate = &learner.agent().learning_rate;
    R::WEIGHTED.then(|| numbered(state).map(|(row, x)| step_size(rate, row, 0) * x * x).sum())
}

/// The rows of a state, each with the number of its feature.
fn numbered<R: ActiveRows>(state: &R) -> impl Iterator<Item = (u32, f64)> + Clone {
    let values = state.values();
    let number = move |index: usize| if R::WEIGHTED { values[index] } else { 1.0 };
    state.as_ref().iter().enumerate().map(move |(index, &row)| (row, number(index)))
}

/// The step size of a weight, whose row can have its own.
fn step_size(rate: &LearningRate, row: u32, weight_index: usize) -> f64 {
    rate.of_rows().map_or_else(|| rate.at(weight_index), |steps| steps[row as usize])
}

impl<R: ActiveRows> StepTerms<R> {
    /// Reads the numbers from a learner, whose tables are complete.
    pub(crate) fn new(
        learner: &mut AnyLearner<R>,
        (state, action, reward): (R, usize, f64),
        next: &Next<R>,
        terminate: bool,
    ) -> Self {
        let (end, next) = match *next {
            Next::NonTerminal(next) => (StepEnd::Continues, learner.next_value(next)),
            Next::Truncated(_) if terminate => (StepEnd::TruncatedAsTerminal, NextValue::None),
            Next::Truncated(next) => (StepEnd::Truncated, learner.next_value(next)),
            Next::Terminal => (StepEnd::Terminal, NextValue::None),
        };
        let (traces, q_old) = learner.traces_of_visit(&state, action);
        let old = learner.agent().value(state, action);
        let weighted_rate = weighted_rate(learner, &state);
        Self { state, action, reward, end, next, old, traces, q_old, weighted_rate }
    }

    /// The update of a table by this step, as the learner logged it.
    pub(crate) fn explain(&self, update: Update, next_action: usize) -> Update {
        let next_value = match &self.next {
            NextValue::None => None,
            NextValue::One(value) => Some(*value),
            NextValue::OfAction(values) => values.get(next_action).copied(),
            NextValue::OfTable(values) => values.get(update.table).copied(),
        };
        Update { end: self.end, reward: Some(self.reward), next_value, ..update }
    }

    /// The update of (S, A) by a learner with traces, whose tables are complete again; `None` without traces.
    pub(crate) fn with_traces(&self, learner: &mut AnyLearner<R>, next_action: usize) -> Option<Update> {
        let rows = self.state.as_ref();
        let dutch = learner.dutch_traces(rows, self.action);
        let traces = dutch.as_ref().unwrap_or(&self.traces);
        let Agent { table, learning_rate, discount, .. } = learner.agent();
        let size = |row: u32| step_size(learning_rate, row, table.weight_index(row, self.action));
        let moved = numbered(&self.state).map(|(row, x)| (size(row) * x, x));
        let gain: f64 = moved.clone().zip(traces).map(|((step, _), trace)| step * trace).sum();
        let learning_rate: f64 = moved.map(|(step, x)| step * x).sum();
        // With several active rows, the trace is the mean that would change the value equally.
        let trace = if learning_rate > 0.0 { gain / learning_rate } else { *traces.first()? };
        let kind = if dutch.is_some() { UpdateKind::DutchTrace } else { UpdateKind::Trace };
        let new = table.value(&self.state, self.action);
        let update = Update::new(kind, self.action, (self.old, new, f64::NAN), Some(learning_rate));
        let update = self.explain(update, next_action);
        let target = update.next_value.map_or(self.reward, |value| self.reward + *discount * value);
        Some(Update { target, trace: Some(trace), q_old: self.q_old, ..update })
    }
}

impl<R: ActiveRows> AnyLearner<R> {
    /// Whether a step can update a state that the agent visited before.
    pub(crate) fn updates_other_states(&self) -> bool {
        matches!(self, Self::NStepSarsa(_) | Self::DynaQ(_) | Self::DynaQPlus(_))
    }

    pub(crate) fn has_traces(&self) -> bool {
        matches!(self, Self::SarsaLambda(_) | Self::TrueOnlineSarsaLambda(_) | Self::WatkinsQLambda(_))
    }

    /// Starts or ends the log of the updates of each table.
    pub(crate) fn set_logging(&mut self, logs: bool) {
        self.learning_rates().for_each(|rate| rate.set_logging(logs));
    }

    /// The learning rate of each table, which logs its updates.
    pub(crate) fn learning_rates(&mut self) -> impl Iterator<Item = &mut LearningRate> {
        let (first, second) = match self {
            Self::DoubleQLearning(learner) => {
                (&mut learner.agent.learning_rate, Some(&mut learner.rule.second_learning_rate))
            }
            other => (&mut other.agent().learning_rate, None),
        };
        std::iter::once(first).chain(second)
    }

    /// The agent, with the first table.
    fn agent(&mut self) -> &mut Agent {
        match self {
            Self::QLearning(learner) => &mut learner.agent,
            Self::Sarsa(learner) => &mut learner.agent,
            Self::ExpectedSarsa(learner) => &mut learner.agent,
            Self::DoubleQLearning(learner) => &mut learner.agent,
            Self::NStepSarsa(learner) => &mut learner.agent,
            Self::SarsaLambda(learner) => &mut learner.agent,
            Self::TrueOnlineSarsaLambda(learner) => &mut learner.agent,
            Self::WatkinsQLambda(learner) => &mut learner.agent,
            Self::DynaQ(learner) => &mut learner.agent,
            Self::DynaQPlus(learner) => &mut learner.agent,
        }
    }

    /// The value of a nonterminal next state, as used in the target.
    fn next_value(&mut self, next: R) -> NextValue {
        match self {
            Self::NStepSarsa(_) => NextValue::None,
            Self::Sarsa(_) | Self::SarsaLambda(_) | Self::TrueOnlineSarsaLambda(_) => {
                NextValue::OfAction(self.agent().action_values(next).to_vec())
            }
            Self::ExpectedSarsa(learner) => NextValue::One(learner.agent.expected_value(next)),
            Self::DoubleQLearning(learner) => {
                let tables = [&learner.agent.table, &learner.rule.second_table];
                let of = |updated: usize| {
                    let values = (0..tables[0].num_actions()).map(|action| tables[updated].value(&next, action));
                    let greedy = values.enumerate().reduce(|best, other| if other.1 > best.1 { other } else { best });
                    greedy.map_or(f64::NAN, |(action, _)| tables[1 - updated].value(&next, action))
                };
                NextValue::OfTable([of(0), of(1)])
            }
            Self::QLearning(_) | Self::WatkinsQLambda(_) | Self::DynaQ(_) | Self::DynaQPlus(_) => {
                let values = self.agent().action_values(next).iter().copied();
                NextValue::One(values.reduce(f64::max).unwrap_or(f64::NAN))
            }
        }
    }

    /// The traces of a pair after a visit, and Qₒ of true online Sarsa(λ).
    fn traces_of_visit(&self, state: &R, action: usize) -> (Vec<f64>, Option<f64>) {
        let visited = |agent: &Agent, traces: &Traces, kind: TraceKind| {
            let visited = |(row, x): (u32, f64)| match kind {
                TraceKind::Accumulating => traces.get_of::<R>(agent.table.weight_index(row, action)) + x,
                TraceKind::Replacing | TraceKind::Clearing => x,
            };
            (numbered(state).map(visited).collect(), None)
        };
        match self {
            Self::SarsaLambda(learner) => visited(&learner.agent, &learner.rule.traces, learner.rule.kind),
            Self::WatkinsQLambda(learner) => visited(&learner.agent, &learner.rule.traces, learner.rule.kind),
            Self::TrueOnlineSarsaLambda(learner) => (Vec::new(), Some(learner.rule.q_old())),
            _ => (Vec::new(), None),
        }
    }

    /// The dutch traces of a pair after the step; `None` for other traces.
    fn dutch_traces(&self, rows: &[u32], action: usize) -> Option<Vec<f64>> {
        let Self::TrueOnlineSarsaLambda(learner) = self else { return None };
        let trace = |&row: &u32| learner.rule.traces.get_of::<R>(learner.agent.table.weight_index(row, action));
        Some(rows.iter().map(trace).collect())
    }
}
