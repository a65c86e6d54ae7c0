//! What a time-out means to a learner (Pardo et al., "Time limits in reinforcement learning", 2018).

use crate::learner::Learner;
use crate::random::Draw;
use crate::world::Next;

/// A learner that may take time-outs for terminal states. Right is that they are none: nothing ends there but our
/// patience. The mistake is kept for those who want to show what it costs.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeOuts<L> {
    /// The learner.
    pub learner: L,
    /// Whether it takes them so.
    pub terminate: bool,
}

impl<R, L: Learner<R>> Learner<R> for TimeOuts<L> {
    #[inline]
    fn begin(&mut self, here: R, draw: &mut impl Draw) -> usize {
        self.learner.begin(here, draw)
    }

    #[inline]
    fn learn(&mut self, here: R, action: usize, reward: f64, next: Next<R>, draw: &mut impl Draw) -> usize {
        let next = match next {
            Next::TimedOut(_) if self.terminate => Next::Terminal,
            next => next,
        };
        self.learner.learn(here, action, reward, next, draw)
    }

    fn end_episode(&mut self) {
        self.learner.end_episode();
    }

    fn tables(&self) -> Vec<&[f64]> {
        self.learner.tables()
    }

    fn diverged(&self) -> bool {
        self.learner.diverged()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learners::example::{agent, draw};
    use crate::learners::{Control, Sarsa};

    #[test]
    fn the_mistake_forgets_what_would_have_followed() {
        for (terminate, value) in [(false, 0.75), (true, 0.0)] {
            let mut learner =
                TimeOuts { learner: Control { agent: agent(&[1.0, 0.0, 2.0, 3.0]), rule: Sarsa }, terminate };
            learner.learn([0], 0, -1.0, Next::TimedOut([1]), &mut draw());
            assert_eq!(learner.learner.agent.table.values()[0], value);
        }
    }
}
