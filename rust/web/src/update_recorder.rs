//! A learner whose updates are seen from outside, so that it stays the same.

use qtab_core::checkpoint::{Checkpoint, CheckpointError};
use qtab_core::random::Rng;
use qtab_core::tasks::Next;
use qtab_core::{Learner, delegate_learner};

use crate::updates::{ObservedStep, Watch};

/// A learner whose updates of a state are watched, if one is.
pub(crate) struct UpdateRecorder<L> {
    learner: L,
    watch: Option<Box<Watch>>,
}

impl<L> UpdateRecorder<L> {
    pub(crate) fn new(learner: L, watch: Option<Watch>) -> Self {
        Self { learner, watch: watch.map(Box::new) }
    }

    pub(crate) fn watch(&self) -> Option<&Watch> {
        self.watch.as_deref()
    }
}

impl<R: Copy + AsRef<[u32]>, L: Learner<R>> Learner<R> for UpdateRecorder<L> {
    delegate_learner!(rest R, learner in Self { learner, .. });

    #[inline]
    fn learn(&mut self, state: R, action: usize, reward: f64, next: Next<R>, rng: &mut impl Rng) -> usize {
        let begun = self.watch.as_mut().map(|watch| (watch.begin_step(state.as_ref()), watch));
        let Some((true, watch)) = begun else { return self.learner.learn(state, action, reward, next, rng) };
        // Traces keep values outside the tables.
        self.learner.complete_tables();
        let (next_rows, truncated) = match &next {
            Next::NonTerminal(rows) => (rows.as_ref(), false),
            Next::Truncated(rows) => (rows.as_ref(), true),
            Next::Terminal => (&[][..], false),
        };
        let before = watch.before(&self.learner.tables(), state.as_ref(), action, next_rows);
        let next_action = self.learner.learn(state, action, reward, next, rng);
        self.learner.complete_tables();
        let chosen = matches!(next, Next::NonTerminal(_)).then_some(next_action);
        let step = ObservedStep { state: state.as_ref(), action, reward, next_rows, truncated, next_action: chosen };
        watch.observe(&step, &before, &self.learner.tables());
        next_action
    }

    fn resume(&mut self, next: Next<R>, rng: &mut impl Rng) -> usize {
        self.learner.resume(next, rng)
    }

    fn end_episode(&mut self) {
        self.learner.end_episode();
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
        let mut recorder = UpdateRecorder::new(TdLearner { agent, rule: Sarsa }, None);
        recorder.set_action_mask([1], &[false, true]);
        assert_eq!(Learner::<[u32; 1]>::action_masks(&recorder), Some([true, true, false, true].as_slice()));
    }
}
