//! The last updates of a state, with the numbers that the learner made them of.

use std::collections::VecDeque;

use serde::Serialize;

/// How many updates are kept.
const KEPT: usize = 8;

/// What an update came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum UpdateKind {
    /// A step from the state, whose target is the reward and the discounted value of the next state.
    Target,
    /// The same, of which all eligible states take their share.
    Trace,
    /// The same with a dutch trace, which also corrects by the value that the step before saw.
    DutchTrace,
    /// A return of several rewards, of a step some time before.
    NStep,
    /// The model.
    Planning,
}

/// What followed the step of an update.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum StepEnd {
    Continues,
    Terminal,
    Truncated,
    /// The time limit ended the episode, and the learner takes the next state as terminal.
    TruncatedAsTerminal,
    /// The update is not that of the step.
    Other,
}

/// An update of a value of the state.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Update {
    pub(crate) kind: UpdateKind,
    pub(crate) end: StepEnd,
    /// The episode and the step, from 0, in which the update was made.
    pub(crate) episode: usize,
    pub(crate) step: usize,
    pub(crate) action: usize,
    /// Which table was updated.
    pub(crate) table: usize,
    pub(crate) old: f64,
    pub(crate) new: f64,
    pub(crate) target: f64,
    /// The learning rate α; `None` if the target replaced the value.
    pub(crate) learning_rate: Option<f64>,
    /// The reward and the value of the next state in the target, where it is made of these.
    pub(crate) reward: Option<f64>,
    pub(crate) next_value: Option<f64>,
    /// The trace z of the value.
    pub(crate) trace: Option<f64>,
    /// The value of the state as the step before saw it, for dutch traces.
    pub(crate) q_old: Option<f64>,
}

impl Update {
    /// An update of the first table, of which no more is known than its equation.
    pub(crate) fn new(
        kind: UpdateKind,
        action: usize,
        (old, new, target): (f64, f64, f64),
        learning_rate: Option<f64>,
    ) -> Self {
        let (end, episode, step, table) = (StepEnd::Other, 0, 0, 0);
        let (reward, next_value, trace, q_old) = (None, None, None, None);
        Self {
            kind,
            end,
            episode,
            step,
            action,
            table,
            old,
            new,
            target,
            learning_rate,
            reward,
            next_value,
            trace,
            q_old,
        }
    }
}

/// The state that is watched, and its updates.
#[derive(Clone, Debug)]
pub(crate) struct Watch {
    rows: Vec<u32>,
    /// The episode, from 0, with which watching begins.
    from: usize,
    episode: usize,
    /// The steps of the episode that have begun.
    steps: usize,
    updates: VecDeque<Update>,
}

impl Watch {
    /// A watch of the state with these active rows, beginning with an episode.
    pub(crate) fn new(rows: Vec<u32>, from: usize) -> Self {
        Self { rows, from, episode: 0, steps: 0, updates: VecDeque::with_capacity(KEPT) }
    }

    /// Whether no update is missing that it would have kept had it begun with the first episode.
    pub(crate) fn is_complete(&self) -> bool {
        self.from == 0 || self.updates.len() == KEPT
    }

    /// The last updates, the newest one last.
    pub(crate) fn updates(&self) -> impl Iterator<Item = &Update> {
        self.updates.iter()
    }

    /// Whether a state is the one that is watched; with tile coding, whether it shares three quarters of its tiles.
    #[inline]
    pub(crate) fn is_near(&self, state: &[u32]) -> bool {
        let shared = state.iter().zip(&self.rows).filter(|(row, watched)| row == watched).count();
        shared * 4 >= self.rows.len() * 3
    }

    /// Counts a step, and returns whether its updates are watched.
    #[inline]
    pub(crate) fn begin_step(&mut self) -> bool {
        self.steps += 1;
        self.is_watching()
    }

    /// Whether watching has begun.
    #[inline]
    pub(crate) fn is_watching(&self) -> bool {
        self.episode >= self.from
    }

    pub(crate) fn end_episode(&mut self) {
        self.episode += 1;
        self.steps = 0;
    }

    /// Keeps an update of the step that has begun last.
    pub(crate) fn push(&mut self, update: Update) {
        if self.updates.len() == KEPT {
            self.updates.pop_front();
        }
        self.updates.push_back(Update { episode: self.episode, step: self.steps.saturating_sub(1), ..update });
    }
}
