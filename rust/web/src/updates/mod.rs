//! The last updates of a state, with the numbers that the learner used.

pub(crate) mod recorder;
mod step_terms;

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use serde::Serialize;

/// The number of updates that are kept.
const KEPT: usize = 8;

/// The source of an update.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum UpdateKind {
    /// A step from the state, whose target is the reward and the discounted value of the next state.
    Target,
    /// A step with the same target, whose error updates all eligible states.
    Trace,
    /// A step with a dutch trace, which also corrects by the value that the previous step used.
    DutchTrace,
    /// The return of several rewards, for an earlier step.
    NStep,
    /// An outcome from the model.
    Planning,
}

/// The end of an update's step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum StepEnd {
    Continues,
    Terminal,
    Truncated,
    /// The time limit ended the episode, and the learner treats the next state as terminal.
    TruncatedAsTerminal,
    /// The update does not belong to the step.
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
    /// The index of the updated table.
    pub(crate) table: usize,
    pub(crate) old: f64,
    pub(crate) new: f64,
    pub(crate) target: f64,
    /// The learning rate α; `None` if the target replaced the value.
    pub(crate) learning_rate: Option<f64>,
    /// The reward and the value of the next state in the target, if it consists of these.
    pub(crate) reward: Option<f64>,
    pub(crate) next_value: Option<f64>,
    /// The trace z of the value.
    pub(crate) trace: Option<f64>,
    /// The value of the state that the previous step used, for dutch traces.
    pub(crate) q_old: Option<f64>,
}

impl Update {
    /// An update of the first table, of which only the equation is known.
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

/// The cell of the state that a run has left with its last step.
pub(crate) type CellLeft = Arc<AtomicUsize>;

/// The state that is watched.
#[derive(Clone, Debug)]
pub(crate) enum Place {
    /// The state with these active rows.
    Rows(Vec<u32>),
    /// The states of a cell of the map, for weighted features: their rows are those of all states.
    Cell { watched: usize, left: CellLeft },
}

/// The state that is watched, with its updates.
#[derive(Clone, Debug)]
pub(crate) struct Watch {
    place: Place,
    /// The first episode that is watched, counted from 0.
    from: usize,
    episode: usize,
    /// The number of steps of the episode that have begun.
    steps: usize,
    updates: VecDeque<Update>,
}

impl Watch {
    /// A watch of a state from an episode on.
    pub(crate) fn new(place: Place, from: usize) -> Self {
        Self { place, from, episode: 0, steps: 0, updates: VecDeque::with_capacity(KEPT) }
    }

    /// The place where the run notes the cell that it leaves with each step, if the cell is watched.
    pub(crate) fn cell_left(&self) -> Option<CellLeft> {
        if let Place::Cell { left, .. } = &self.place { Some(Arc::clone(left)) } else { None }
    }

    /// Whether all updates were kept that would have been kept when watching from the first episode.
    pub(crate) fn is_complete(&self) -> bool {
        self.from == 0 || self.updates.len() == KEPT
    }

    /// The last updates, the newest one last.
    pub(crate) fn updates(&self) -> impl Iterator<Item = &Update> {
        self.updates.iter()
    }

    /// Whether a state is the watched one; with tile coding, whether it shares three quarters of its tiles. If a cell is
    /// watched, the state must be the one that the last step has left.
    #[inline]
    pub(crate) fn is_near(&self, state: &[u32]) -> bool {
        match &self.place {
            Place::Rows(rows) => {
                let shared = state.iter().zip(rows).filter(|(row, watched)| row == watched).count();
                shared * 4 >= rows.len() * 3
            }
            Place::Cell { watched, left } => left.load(Ordering::Relaxed) == *watched,
        }
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

    /// Records an update of the step that began last.
    pub(crate) fn push(&mut self, update: Update) {
        if self.updates.len() == KEPT {
            self.updates.pop_front();
        }
        self.updates.push_back(Update { episode: self.episode, step: self.steps.saturating_sub(1), ..update });
    }
}
