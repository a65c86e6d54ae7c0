//! The active rows of the lanes before and after a step.

/// The active rows of the current states and of the next ones. The two buffers swap roles instead of being copied,
/// because a processor stalls if it copies numbers in vector registers right after they were written in smaller parts.
pub(super) struct RowBuffers<R, const K: usize> {
    buffers: [[R; K]; 2],
    /// Whether the current rows are in the second buffer.
    second: bool,
}

impl<R: Copy + Default, const K: usize> RowBuffers<R, K> {
    pub(super) fn new() -> Self {
        Self { buffers: [[R::default(); K]; 2], second: false }
    }

    /// The rows of the current states.
    #[inline(always)]
    pub(super) fn current(&self) -> &[R; K] {
        &self.buffers[usize::from(self.second)]
    }

    /// The rows of the current states, mutable.
    #[inline(always)]
    pub(super) fn current_mut(&mut self) -> &mut [R; K] {
        &mut self.buffers[usize::from(self.second)]
    }

    /// The rows of the next states.
    #[inline(always)]
    pub(super) fn next(&self) -> &[R; K] {
        &self.buffers[usize::from(!self.second)]
    }

    /// The rows of the next states, mutable.
    #[inline(always)]
    pub(super) fn next_mut(&mut self) -> &mut [R; K] {
        &mut self.buffers[usize::from(!self.second)]
    }

    /// Makes the next states the current ones.
    #[inline(always)]
    pub(super) fn advance(&mut self) {
        self.second = !self.second;
    }
}
