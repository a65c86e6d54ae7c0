//! The ε-greedy decisions of the next steps. They do not depend on the steps, so they are drawn in advance: a tight loop
//! per lane, instead of a part of every step.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use std::hint::select_unpredictable;

use crate::random::{DrawIndex, PrefetchedPcg64};

/// The number of steps that decisions are drawn for in advance. Few, because those after the end of an episode are drawn
/// again, with the next epsilon.
pub(super) const BLOCK: usize = 16;

/// Stands for the greedy action.
pub(super) const GREEDY: usize = usize::MAX;

/// The decisions that follow the steps of a block.
pub(super) struct Decisions<const K: usize> {
    /// The random action of each lane after each step, or [`GREEDY`].
    pub(super) actions: [[usize; K]; BLOCK],
    /// Where each lane's decisions begin: at this step, with its generator at this position.
    starts: [(usize, DrawIndex); K],
}

impl<const K: usize> Decisions<K> {
    /// No decisions.
    pub(super) fn new(rngs: &[PrefetchedPcg64; K]) -> Self {
        Self { actions: [[GREEDY; K]; BLOCK], starts: rngs.each_ref().map(|rng| (0, rng.position())) }
    }

    /// Draws a lane's decisions from this step of the block on.
    #[inline(always)]
    pub(super) fn draw<const N: usize>(
        &mut self,
        lane: usize,
        first: usize,
        explore_from: u64,
        rng: &mut PrefetchedPcg64,
    ) {
        self.starts[lane] = (first, rng.position());
        let actions = &mut self.actions[first..];
        rng.explore_many(actions.len(), explore_from, N as u32, |step, explores, random| {
            actions[step][lane] = select_unpredictable(explores, random, GREEDY);
        });
    }

    /// Returns a lane's generator to where it is after the decisions before this step of the block.
    pub(super) fn rewind<const N: usize>(
        &self,
        lane: usize,
        step: usize,
        explore_from: u64,
        rng: &mut PrefetchedPcg64,
    ) {
        let (first, position) = self.starts[lane];
        rng.rewind(position);
        rng.explore_many(step - first, explore_from, N as u32, |_, _, _| {});
    }
}
