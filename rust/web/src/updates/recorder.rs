//! A learner that records the updates of a state. The learned values are unchanged.

use std::collections::VecDeque;

use qtab_core::checkpoint::{Checkpoint, CheckpointError};
use qtab_core::features::ActiveRows;
use qtab_core::learners::TransformedSteps;
use qtab_core::random::Rng;
use qtab_core::schedules::LoggedUpdate;
use qtab_core::tasks::Next;
use qtab_core::{Learner, delegate_learner};

use crate::learners::AnyLearner;
use crate::updates::step_terms::{StepTerms, weighted_rate};
use crate::updates::{Update, UpdateKind, Watch};

/// A learner, and the state whose updates are watched, if any.
pub(crate) struct UpdateRecorder<R: ActiveRows> {
    learner: TransformedSteps<AnyLearner<R>>,
    watch: Option<Box<Watch>>,
    /// With weighted features, for each step of an n-step method that waits for its update: the rate of its value if its
    /// state is the watched one. Updates come in the order of the steps.
    waiting: VecDeque<Option<f64>>,
}

impl<R: ActiveRows> UpdateRecorder<R> {
    pub(crate) fn new(learner: TransformedSteps<AnyLearner<R>>, watch: Option<Watch>) -> Self {
        Self { learner, watch: watch.map(Box::new), waiting: VecDeque::new() }
    }

    pub(crate) fn watch(&self) -> Option<&Watch> {
        self.watch.as_deref()
    }

    /// Learns from a step, and records its updates of the watched state.
    #[cold]
    #[inline(never)]
    fn learn_watched(&mut self, step: (R, usize, f64), next: Next<R>, rng: &mut impl Rng) -> usize {
        let (state, action, reward) = step;
        let near = self.watch.as_ref().is_some_and(|watch| watch.is_near(state.as_ref()));
        if !near && !self.learner.learner.updates_other_states() {
            return self.learner.learn(state, action, reward, next, rng);
        }
        // Learners with traces keep values outside the tables.
        self.learner.complete_tables();
        let terminate = self.learner.terminate;
        let terms = near.then(|| StepTerms::new(&mut self.learner.learner, step, &next, terminate));
        if R::WEIGHTED && matches!(self.learner.learner, AnyLearner::NStepSarsa(_)) {
            let rate = if near { weighted_rate(&mut self.learner.learner, &state) } else { None };
            self.waiting.push_back(rate);
        }
        let traces = self.learner.learner.has_traces();
        self.learner.learner.set_logging(!traces);
        let next_action = self.learner.learn(state, action, reward, next, rng);
        if traces {
            self.learner.complete_tables();
            let update = terms.and_then(|terms| terms.with_traces(&mut self.learner.learner, next_action));
            if let (Some(watch), Some(update)) = (&mut self.watch, update) {
                watch.push(update);
            }
            return next_action;
        }
        self.learner.learner.set_logging(false);
        self.keep_logged(terms.as_ref().map(|terms| (terms, next_action)), true);
        next_action
    }

    /// Records the logged updates of the state. The first one is that of a step, if there was one.
    fn keep_logged(&mut self, step: Option<(&StepTerms<R>, usize)>, from_step: bool) {
        let Some(watch) = &mut self.watch else { return };
        let learner = &mut self.learner.learner;
        let several = matches!(learner, AnyLearner::NStepSarsa(_));
        for (table, rate) in learner.learning_rates().enumerate() {
            for (index, (rows, logged)) in rate.logged().iter().enumerate() {
                let LoggedUpdate { action, old, new, target, mut learning_rate } = *logged;
                if R::WEIGHTED {
                    let of_step = step.and_then(|(terms, _)| terms.weighted_rate);
                    learning_rate = if several { self.waiting.pop_front().flatten() } else { of_step };
                }
                let is_shown = if R::WEIGHTED { learning_rate.is_some() } else { watch.is_near(rows) };
                if !is_shown {
                    continue;
                }
                let is_own = from_step && index == 0 && !several;
                let kind = match (several, is_own) {
                    (true, _) => UpdateKind::NStep,
                    (false, true) => UpdateKind::Target,
                    (false, false) => UpdateKind::Planning,
                };
                let update = Update { table, ..Update::new(kind, action, (old, new, target), learning_rate) };
                watch.push(match step.filter(|_| is_own) {
                    Some((terms, next_action)) => terms.explain(update, next_action),
                    None => update,
                });
            }
            rate.logged().clear();
        }
    }
}

impl<R: ActiveRows> Learner<R> for UpdateRecorder<R> {
    delegate_learner!(rest R, learner in Self { learner, .. });

    #[inline]
    fn learn(&mut self, state: R, action: usize, reward: f64, next: Next<R>, rng: &mut impl Rng) -> usize {
        let watches = self.watch.as_mut().is_some_and(|watch| watch.begin_step());
        if watches {
            self.learn_watched((state, action, reward), next, rng)
        } else {
            self.learner.learn(state, action, reward, next, rng)
        }
    }

    fn resume(&mut self, next: Next<R>, rng: &mut impl Rng) -> usize {
        self.learner.learner.set_logging(self.watch.as_ref().is_some_and(|watch| watch.is_watching()));
        let next_action = self.learner.resume(next, rng);
        self.learner.learner.set_logging(false);
        self.keep_logged(None, false);
        next_action
    }

    fn end_episode(&mut self) {
        self.learner.end_episode();
        self.waiting.clear();
        if let Some(watch) = &mut self.watch {
            watch.end_episode();
        }
    }

    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.learner.persist(checkpoint)
    }
}

#[cfg(test)]
mod tests {
    use qtab_core::QTable;
    use qtab_core::learners::{ActionMasks, Agent, Sarsa, TdLearner};
    use qtab_core::policies::AnyPolicy;
    use qtab_core::q_table::TerminalUpdate;
    use qtab_core::schedules::{LearningRate, Schedule};

    use super::*;

    #[test]
    fn the_actions_of_a_state_reach_the_learner() {
        let agent: Agent = Agent {
            table: QTable::new(vec![0.0; 4], 2),
            policy: AnyPolicy::softmax(1.0, 2),
            learning_rate: LearningRate::scheduled(Schedule::constant(0.1), 1),
            discount: 1.0,
            terminal_update: TerminalUpdate::Target,
            masks: Some(Box::new(ActionMasks::known(vec![true; 4], 2))),
        };
        let learner = AnyLearner::Sarsa(TdLearner { agent, rule: Sarsa });
        let learner = TransformedSteps { learner, terminate: false, bonus: None };
        let mut recorder = UpdateRecorder::<[u32; 1]>::new(learner, None);
        recorder.set_action_mask([1], &[false, true]);
        assert_eq!(recorder.action_masks(), Some([true, true, false, true].as_slice()));
    }
}
