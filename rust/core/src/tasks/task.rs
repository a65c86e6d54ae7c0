//! What a learner meets: rows in, action index out.

/// What follows a step, as far as the update is concerned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next<R> {
    /// The episode goes on in these rows.
    NonTerminal(R),
    /// The time limit has come: the episode ends, the task does not, so the update bootstraps from these rows.
    Truncated(R),
    /// A terminal state: nothing follows. It wins where a time-out coincides.
    Terminal,
}

/// What one step brings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transition<R> {
    /// The reward of the step.
    pub reward: f64,
    /// What follows it.
    pub next: Next<R>,
}

/// An environment with its features and its time limit; fallible, because Python's environments are.
pub trait Task {
    /// Where an episode stands. Passed back at every step, so that a loop can keep it in registers.
    type State: Copy;
    /// The rows an observation lights.
    type Active: Copy + AsRef<[u32]>;
    /// What can go wrong.
    type Error;

    /// Begins an episode.
    ///
    /// # Errors
    /// Whatever the environment raises, or an observation that the features have no row for.
    fn reset(&mut self) -> Result<(Self::State, Self::Active), Self::Error>;

    /// Takes one step of the episode.
    ///
    /// # Errors
    /// As for `reset`.
    fn step(&mut self, state: &mut Self::State, action: usize) -> Result<Transition<Self::Active>, Self::Error>;
}
