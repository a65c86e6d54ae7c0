//! The flag by which a caller stops long work.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};

/// A flag that long work looks at every few hundred microseconds. Another thread sets it, or the flag asks a function
/// each time, where there is no other thread.
pub struct StopFlag<'a> {
    stopped: AtomicBool,
    poll: Option<&'a (dyn Fn() -> bool + Sync)>,
}

impl<'a> StopFlag<'a> {
    /// A flag that is not set.
    pub const fn new() -> Self {
        Self { stopped: AtomicBool::new(false), poll: None }
    }

    /// A flag that `poll` sets by returning true.
    pub fn polling(poll: &'a (dyn Fn() -> bool + Sync)) -> Self {
        Self { stopped: AtomicBool::new(false), poll: Some(poll) }
    }

    /// Stops the work.
    pub fn set(&self) {
        self.stopped.store(true, Ordering::Release);
    }

    /// Whether the work is to stop.
    pub fn is_set(&self) -> bool {
        if !self.stopped.load(Ordering::Acquire) && self.poll.is_some_and(|poll| poll()) {
            self.set();
        }
        self.stopped.load(Ordering::Acquire)
    }
}

impl Default for StopFlag<'_> {
    fn default() -> Self {
        Self::new()
    }
}

impl fmt::Debug for StopFlag<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("StopFlag").field("stopped", &self.stopped).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flag_stays_set() {
        let asked = AtomicBool::new(false);
        let once = || !asked.swap(true, Ordering::Relaxed);
        let flag = StopFlag::polling(&once);
        assert!(flag.is_set());
        assert!(flag.is_set());
        assert!(!StopFlag::new().is_set());
    }
}
