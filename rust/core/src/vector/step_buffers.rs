//! The buffers that a step writes its results to.

/// The buffers that a step writes its results to, with one element per sub-environment.
#[derive(Debug)]
pub struct StepBuffers<'a, O> {
    /// The observations after the step.
    pub observations: &'a mut [O],
    /// The rewards; 0 for a step that was a reset.
    pub rewards: &'a mut [f64],
    /// Whether the next state is terminal.
    pub terminated: &'a mut [bool],
    /// Whether the time limit was reached. Both `terminated` and `truncated` can be true.
    pub truncated: &'a mut [bool],
}

impl<'a, O> StepBuffers<'a, O> {
    /// The buffers of the shards, which have `len` sub-environments each.
    pub(super) fn chunks(self, len: usize) -> impl Iterator<Item = StepBuffers<'a, O>> {
        let values = self.observations.chunks_mut(len).zip(self.rewards.chunks_mut(len));
        let flags = self.terminated.chunks_mut(len).zip(self.truncated.chunks_mut(len));
        values.zip(flags).map(|((observations, rewards), (terminated, truncated))| StepBuffers {
            observations,
            rewards,
            terminated,
            truncated,
        })
    }
}
