//! Where a step writes its results.

/// What a step brings, a place for each sub-environment.
#[derive(Debug)]
pub struct StepBuffers<'a, O> {
    /// What each shows after the step.
    pub observations: &'a mut [O],
    /// 0 for a step that was a reset.
    pub rewards: &'a mut [f64],
    /// Whether each has come to a terminal state …
    pub terminated: &'a mut [bool],
    /// … or to its time limit. Both may be.
    pub truncated: &'a mut [bool],
}

impl<'a, O> StepBuffers<'a, O> {
    /// The places of each block.
    pub(super) fn chunks(self, length: usize) -> impl Iterator<Item = StepBuffers<'a, O>> {
        let places = self.observations.chunks_mut(length).zip(self.rewards.chunks_mut(length));
        let ends = self.terminated.chunks_mut(length).zip(self.truncated.chunks_mut(length));
        places.zip(ends).map(|((observations, rewards), (terminated, truncated))| StepBuffers {
            observations,
            rewards,
            terminated,
            truncated,
        })
    }
}
