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
