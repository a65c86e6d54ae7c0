//! The k-armed bandit testbed (Sutton & Barto, section 2.3).

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::{Next, RngSnapshot, Task, Transition};
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::features::OutOfBounds;
use crate::memory::{AllocationError, with_capacity};
use crate::numeric::argmax;
use crate::random::Pcg64;

/// The distribution that a bandit problem is drawn from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Testbed {
    /// k, the number of actions.
    pub num_actions: usize,
    /// The mean of the true values q⁎(a).
    pub mean: f64,
    /// The standard deviation of the true values.
    pub deviation: f64,
    /// The standard deviation of the random-walk increments added to each true value after each action; 0 for a
    /// stationary problem.
    pub random_walk: f64,
}

/// Whether the optimal action was taken in each episode; false for unfinished episodes. It is shared by the task, which
/// writes it, and its reader.
pub type OptimalActions = Arc<Vec<AtomicBool>>;

/// A bandit problem, drawn by the first reset: q⁎(a) is normal, and a reward is normal with mean q⁎(A) and variance 1.
/// An episode consists of one action.
///
/// It is a task, not an environment, because the problem outlasts an episode.
#[derive(Clone, Debug)]
pub struct KArmedBandit {
    testbed: Testbed,
    /// The true values q⁎; empty before the first reset.
    values: Vec<f64>,
    /// The action with the largest true value.
    optimal: usize,
    rng: Pcg64,
    /// Whether the optimal action was taken, for each recorded episode; empty if none is recorded.
    optimal_actions: OptimalActions,
    /// The number of finished episodes since the construction.
    episode: usize,
}

impl KArmedBandit {
    /// A problem of the testbed; `rng` is the environment's generator.
    pub fn new(testbed: Testbed, rng: Pcg64) -> Self {
        Self { testbed, values: Vec::new(), optimal: 0, rng, optimal_actions: Arc::default(), episode: 0 }
    }

    /// Records whether the optimal action is taken in each of the first `episodes` episodes.
    ///
    /// # Errors
    /// `OutOfMemory`.
    pub fn record(&mut self, episodes: usize) -> Result<OptimalActions, AllocationError> {
        let mut flags = with_capacity(episodes)?;
        flags.resize_with(episodes, AtomicBool::default);
        self.optimal_actions = Arc::new(flags);
        Ok(Arc::clone(&self.optimal_actions))
    }

    /// Draws the true values q⁎.
    fn draw(&mut self) {
        let Testbed { num_actions, mean, deviation, .. } = self.testbed;
        self.values = (0..num_actions).map(|_| mean + deviation * self.rng.standard_normal()).collect();
        self.optimal = argmax(&self.values);
    }

    /// q⁎(a) ← q⁎(a) + an independent increment, for each action.
    fn walk(&mut self) {
        for value in &mut self.values {
            *value += self.testbed.random_walk * self.rng.standard_normal();
        }
        self.optimal = argmax(&self.values);
    }
}

impl Task for KArmedBandit {
    type State = ();
    type Active = [u32; 1];
    type Error = OutOfBounds;

    fn reset(&mut self) -> Result<((), [u32; 1]), OutOfBounds> {
        if self.values.is_empty() {
            self.draw();
        }
        Ok(((), [0]))
    }

    fn step(&mut self, _state: &mut (), action: usize) -> Result<Transition<[u32; 1]>, OutOfBounds> {
        let reward = self.values[action] + self.rng.standard_normal();
        if let Some(flag) = self.optimal_actions.get(self.episode) {
            flag.store(action == self.optimal, Ordering::Relaxed);
        }
        self.episode += 1;
        if self.testbed.random_walk != 0.0 {
            self.walk();
        }
        Ok(Transition { reward, next: Next::Terminal })
    }

    /// A random walk draws a number for each action.
    fn step_work(&self) -> u64 {
        if self.testbed.random_walk == 0.0 { 0 } else { self.testbed.num_actions as u64 }
    }

    fn active_rows(&self, _state: &()) -> Result<[u32; 1], OutOfBounds> {
        Ok([0])
    }

    fn persist(&mut self, _state: Option<&mut ()>, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.rng.persist(checkpoint)?;
        let mut drawn = !self.values.is_empty();
        drawn.persist(checkpoint)?;
        self.values.resize(if drawn { self.testbed.num_actions } else { 0 }, 0.0);
        self.values.persist(checkpoint)?;
        if drawn {
            self.optimal = argmax(&self.values);
        }
        Ok(())
    }
}

/// The snapshot is the number of 64-bit words drawn since seeding, and the buffered 32-bit half.
impl RngSnapshot for KArmedBandit {
    type Snapshot = (u64, Option<u32>);

    fn rng_snapshot(&self) -> Result<Self::Snapshot, OutOfBounds> {
        Ok((self.rng.words_drawn(), self.rng.buffered_u32()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SeedSequence;

    const BOOK: Testbed = Testbed { num_actions: 10, mean: 0.0, deviation: 1.0, random_walk: 0.0 };

    fn bandit(testbed: Testbed) -> KArmedBandit {
        KArmedBandit::new(testbed, Pcg64::new(&SeedSequence::new(&[0])))
    }

    #[test]
    fn the_problem_stays_the_same_from_episode_to_episode() {
        let mut bandit = bandit(BOOK);
        bandit.reset().expect("a reset");
        let values = bandit.values.clone();
        let mean = (0..10_000).map(|_| {
            bandit.reset().expect("a reset");
            bandit.step(&mut (), 3).expect("a step").reward / 1e4
        });
        // Within four standard errors.
        assert!((mean.sum::<f64>() - values[3]).abs() < 0.04);
        assert_eq!(bandit.values, values);
    }

    #[test]
    fn a_random_walk_moves_every_value() {
        let mut bandit = bandit(Testbed { deviation: 0.0, random_walk: 0.01, ..BOOK });
        bandit.reset().expect("a reset");
        assert_eq!(bandit.values, [0.0; 10]);
        bandit.step(&mut (), 0).expect("a step");
        assert!(bandit.values.iter().all(|value| *value != 0.0 && value.abs() < 0.05));
    }
}
