//! The last updates of a state, with their numbers: what a learner does is seen from outside, so that it stays the same.

use std::collections::VecDeque;

use qtab_core::learners::AnyAlgorithm;
use qtab_core::q_table::TerminalUpdate;
use qtab_core::schedules::Schedule;

use crate::episode::action_value;
use crate::settings::{LearningRateSetting, Settings};

/// How many updates are kept.
const KEPT: usize = 8;

/// What an update came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum UpdateKind {
    /// A step from the state, whose target is the reward and the discounted value of the next state.
    Target,
    /// A step to a terminal state, whose reward the value was set to.
    Assign,
    /// A step from the state, whose error all eligible states share.
    Trace,
    /// A return of several rewards, of a step some time before.
    NStep,
    /// The model.
    Planning,
}

/// An update of a value of the state.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Update {
    pub(crate) kind: UpdateKind,
    /// The episode and the step, from 0, in which the update was made.
    pub(crate) episode: usize,
    pub(crate) step: usize,
    pub(crate) action: usize,
    /// Which table was updated.
    pub(crate) table: usize,
    pub(crate) old: f64,
    pub(crate) new: f64,
    pub(crate) learning_rate: f64,
    pub(crate) reward: Option<f64>,
    pub(crate) next_value: Option<f64>,
    pub(crate) target: Option<f64>,
    /// The active rows of the next state; none if it is terminal, or the step is not the update's.
    pub(crate) next_rows: Vec<u32>,
    pub(crate) truncated: bool,
}

/// The state that is watched, and the updates of it that were seen.
#[derive(Clone, Debug)]
pub(crate) struct Watch {
    rows: Vec<u32>,
    num_actions: usize,
    algorithm: AnyAlgorithm,
    discount: f64,
    assigns: bool,
    learning_rate: LearningRateSetting,
    /// How often each action was taken in the state.
    visits: Vec<u32>,
    episode: usize,
    /// The steps of the episode that have begun.
    steps: usize,
    updates: VecDeque<Update>,
}

impl Watch {
    pub(crate) fn new(rows: Vec<u32>, num_actions: usize, settings: &Settings) -> Self {
        Self {
            rows,
            num_actions,
            algorithm: settings.algorithm,
            discount: settings.discount,
            assigns: settings.terminal_update == TerminalUpdate::Assign,
            learning_rate: settings.learning_rate,
            visits: vec![0; num_actions],
            episode: 0,
            steps: 0,
            updates: VecDeque::with_capacity(KEPT),
        }
    }

    /// The last updates, the newest one last.
    pub(crate) fn updates(&self) -> impl Iterator<Item = &Update> {
        self.updates.iter()
    }

    /// Whether a state is the one that is watched; with tile coding, whether it shares three quarters of its tiles.
    fn is_near(&self, state: &[u32]) -> bool {
        let shared = state.iter().zip(&self.rows).filter(|(row, watched)| row == watched).count();
        shared * 4 >= self.rows.len() * 3
    }

    fn schedule(&self) -> Schedule {
        match self.learning_rate {
            LearningRateSetting::Schedule(schedule) => schedule,
            LearningRateSetting::Visits { value, .. } => Schedule::constant(value),
        }
    }

    /// The learning rate of an update now.
    fn learning_rate(&self, action: usize) -> f64 {
        match self.learning_rate {
            LearningRateSetting::Schedule(schedule) => schedule.value(),
            LearningRateSetting::Visits { value, minimum } => {
                (value / f64::from(self.visits[action].max(1))).max(minimum)
            }
        }
    }

    fn push(&mut self, update: Update) {
        if self.updates.len() == KEPT {
            self.updates.pop_front();
        }
        self.updates.push_back(update);
    }

    /// The action values of the state in each table.
    fn values(&self, tables: &[&[f64]]) -> Vec<f64> {
        let value = |table, action| action_value(&[table], &self.rows, self.num_actions, action).unwrap_or(f64::NAN);
        tables.iter().flat_map(|&table| (0..self.num_actions).map(move |action| value(table, action))).collect()
    }

    /// The value of the next state that the target holds, where it is known without a draw of its own.
    fn next_value(&self, next_values: &[f64], next_action: Option<usize>) -> Option<f64> {
        use AnyAlgorithm::{DynaQ, DynaQPlus, QLearning, Sarsa, SarsaLambda, TrueOnlineSarsaLambda, WatkinsQLambda};
        match self.algorithm {
            QLearning | DynaQ { .. } | DynaQPlus { .. } | WatkinsQLambda(_) => {
                next_values.iter().copied().reduce(f64::max)
            }
            Sarsa | SarsaLambda(_) | TrueOnlineSarsaLambda { .. } => next_values.get(next_action?).copied(),
            _ => None,
        }
    }

    fn has_traces(&self) -> bool {
        use AnyAlgorithm::{SarsaLambda, TrueOnlineSarsaLambda, WatkinsQLambda};
        matches!(self.algorithm, SarsaLambda(_) | TrueOnlineSarsaLambda { .. } | WatkinsQLambda(_))
    }
}

/// A step as the learner was told of it.
pub(crate) struct ObservedStep<'a> {
    pub(crate) state: &'a [u32],
    pub(crate) action: usize,
    pub(crate) reward: f64,
    pub(crate) next_rows: &'a [u32],
    pub(crate) truncated: bool,
    /// The action that the learner chose next; `None` at the end of an episode.
    pub(crate) next_action: Option<usize>,
}

/// The values that a step may change, or uses, before it.
#[derive(Default)]
pub(crate) struct ValuesBefore {
    /// The value of the step's action in each table.
    own: Vec<f64>,
    /// The action values of the next state, summed over the tables.
    next: Vec<f64>,
    /// The action values of the state that is watched, in each table.
    watched: Vec<f64>,
}

impl Watch {
    /// Counts a step, and returns whether it may update the state: by itself, or through a return or a model.
    pub(crate) fn begin_step(&mut self, state: &[u32]) -> bool {
        use AnyAlgorithm::{DynaQ, DynaQPlus, NStepSarsa};
        self.steps += 1;
        matches!(self.algorithm, NStepSarsa { .. } | DynaQ { .. } | DynaQPlus { .. }) || self.is_near(state)
    }

    pub(crate) fn before(&self, tables: &[&[f64]], state: &[u32], action: usize, next_rows: &[u32]) -> ValuesBefore {
        let value = |tables: &[&[f64]], rows: &[u32], action| {
            action_value(tables, rows, self.num_actions, action).unwrap_or(f64::NAN)
        };
        let mut before = ValuesBefore { watched: self.values(tables), ..ValuesBefore::default() };
        if self.is_near(state) {
            before.own = tables.iter().map(|&table| value(&[table], state, action)).collect();
            if !next_rows.is_empty() {
                before.next = (0..self.num_actions).map(|action| value(tables, next_rows, action)).collect();
            }
        }
        before
    }

    /// Notes what a step changed; `tables` are those after it.
    pub(crate) fn observe(&mut self, step: &ObservedStep<'_>, before: &ValuesBefore, tables: &[&[f64]]) {
        let near = self.is_near(step.state);
        if near {
            self.visits[step.action] += 1;
        }
        let own_step = near && !matches!(self.algorithm, AnyAlgorithm::NStepSarsa { .. });
        let own = if own_step { self.own_update(step, before, tables) } else { None };
        if !self.has_traces() {
            self.other_updates(step, before, tables, own);
        }
    }

    /// The update of the step itself. Returns the index of the value that it explains, and its new value.
    fn own_update(
        &mut self,
        step: &ObservedStep<'_>,
        before: &ValuesBefore,
        tables: &[&[f64]],
    ) -> Option<(usize, f64)> {
        let values: Option<Vec<f64>> =
            tables.iter().map(|&table| action_value(&[table], step.state, self.num_actions, step.action)).collect();
        let values = values?;
        let table = before.own.iter().zip(&values).position(|(before, after)| before != after).unwrap_or(0);
        let (&old, &observed) = before.own.get(table).zip(values.get(table))?;
        let learning_rate = self.learning_rate(step.action);
        let terminal = step.next_rows.is_empty();
        let mut kind = if self.has_traces() { UpdateKind::Trace } else { UpdateKind::Target };
        let mut next_value = Some(0.0);
        if terminal && self.assigns {
            kind = UpdateKind::Assign;
        } else if !terminal {
            next_value = self.next_value(&before.next, step.next_action);
            if next_value.is_none() && kind == UpdateKind::Target && learning_rate > 0.0 && self.discount > 0.0 {
                next_value = Some((old + (observed - old) / learning_rate - step.reward) / self.discount);
            }
        }
        let target = next_value.map(|value| if terminal { step.reward } else { step.reward + self.discount * value });
        // Planning may have changed the value once more since.
        let new = match (self.algorithm.needs_single_rows(), kind, target) {
            (true, UpdateKind::Target, Some(target)) => old + learning_rate * (target - old),
            (true, UpdateKind::Assign, _) => step.reward,
            _ => observed,
        };
        self.push(Update {
            kind,
            episode: self.episode,
            step: self.steps - 1,
            action: step.action,
            table,
            old,
            new,
            learning_rate,
            reward: Some(step.reward),
            next_value,
            target,
            next_rows: step.next_rows.to_vec(),
            truncated: step.truncated,
        });
        Some((table * self.num_actions + step.action, new))
    }

    /// Changes of the state's values that are not the step's own.
    fn other_updates(
        &mut self,
        step: &ObservedStep<'_>,
        before: &ValuesBefore,
        tables: &[&[f64]],
        own: Option<(usize, f64)>,
    ) {
        let kind = match self.algorithm {
            AnyAlgorithm::NStepSarsa { .. } => UpdateKind::NStep,
            AnyAlgorithm::DynaQ { .. } | AnyAlgorithm::DynaQPlus { .. } => UpdateKind::Planning,
            _ => return,
        };
        for (index, (&old, &new)) in before.watched.iter().zip(&self.values(tables)).enumerate() {
            let old = own.filter(|(explained, _)| *explained == index).map_or(old, |(_, new)| new);
            // The last bits of the own update may differ from those computed here.
            if (old - new).abs() <= 1e-12 * old.abs().max(new.abs()) {
                continue;
            }
            let action = index % self.num_actions;
            let learning_rate = self.learning_rate(action);
            let target = (learning_rate > 0.0).then(|| old + (new - old) / learning_rate);
            self.push(Update {
                kind,
                episode: self.episode,
                step: self.steps - 1,
                action,
                table: index / self.num_actions,
                old,
                new,
                learning_rate,
                reward: None,
                next_value: None,
                target,
                next_rows: Vec::new(),
                truncated: step.truncated,
            });
        }
    }

    pub(crate) fn end_episode(&mut self) {
        let mut schedule = self.schedule();
        schedule.end_episode();
        if let LearningRateSetting::Schedule(current) = &mut self.learning_rate {
            *current = schedule;
        }
        self.episode += 1;
        self.steps = 0;
    }
}
