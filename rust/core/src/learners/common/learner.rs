//! What a learner is: the owner of its table, its policy and its schedules.

use crate::random::Rng;
use crate::tasks::Next;

/// A learner over rows `R`. Draws come from the agent's stream, in the order that the algorithm's reference states.
pub trait Learner<R> {
    /// The first action of an episode.
    fn first_action(&mut self, state: R, rng: &mut impl Rng) -> usize;

    /// Learns from one step and returns the next action; what it returns where the episode ends is not used.
    fn learn(&mut self, state: R, action: usize, reward: f64, next: Next<R>, rng: &mut impl Rng) -> usize;

    /// Called after the last step of every episode.
    fn end_episode(&mut self);

    /// The tables, rows first; the sum of them is what the greedy policy reads.
    fn tables(&self) -> Vec<&[f64]>;

    /// Whether a value has overflowed: what follows is worth nothing.
    fn diverged(&self) -> bool;
}
