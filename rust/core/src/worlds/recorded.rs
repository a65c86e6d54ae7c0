//! Keeps what it takes to play the last episodes again: how each began, and its actions.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};

use super::Native;
use crate::env::Env;
use crate::features::Features;
use crate::world::{Next, Transition, World};

/// A world that can say from where its next episode begins.
pub trait Start: World {
    /// Enough to begin the same episode again: the state of the stream that the reset and the steps draw from.
    type Start;

    /// Where the stream stands now.
    ///
    /// # Errors
    /// Whatever the environment raises.
    fn start(&self) -> Result<Self::Start, Self::Error>;
}

/// The stream of a native world: how many words were drawn since seeding, and the buffered half.
impl<E: Env<Action = usize>, F: Features<E::Observation>> Start for Native<E, F> {
    type Start = (u64, Option<u32>);

    fn start(&self) -> Result<Self::Start, Self::Error> {
        Ok((self.draw().drawn(), self.draw().half()))
    }
}

/// An episode that can be played again.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording<S> {
    /// How it began.
    pub start: S,
    /// What was done.
    pub actions: Vec<u32>,
}

/// The last finished episodes, oldest first, shared by the world that records and whoever asks later.
pub type Recordings<S> = Arc<Mutex<VecDeque<Recording<S>>>>;

/// A world that keeps the last finished episodes.
#[derive(Debug)]
pub struct Recorded<W: Start> {
    world: W,
    keep: usize,
    underway: Option<Recording<W::Start>>,
    finished: Recordings<W::Start>,
}

impl<W: Start> Recorded<W> {
    /// Keeps the last `keep` finished episodes of `world`.
    pub fn new(world: W, keep: usize) -> (Self, Recordings<W::Start>) {
        let finished = Arc::default();
        (Self { world, keep, underway: None, finished: Arc::clone(&finished) }, finished)
    }

    fn finish(&mut self) {
        if let Some(recording) = self.underway.take() {
            let mut finished = self.finished.lock().unwrap_or_else(PoisonError::into_inner);
            finished.push_back(recording);
            while finished.len() > self.keep {
                finished.pop_front();
            }
        }
    }
}

impl<W: Start> World for Recorded<W> {
    type State = W::State;
    type Rows = W::Rows;
    type Error = W::Error;

    fn reset(&mut self) -> Result<(W::State, W::Rows), W::Error> {
        self.underway = Some(Recording { start: self.world.start()?, actions: Vec::new() });
        self.world.reset()
    }

    fn step(&mut self, state: &mut W::State, action: usize) -> Result<Transition<W::Rows>, W::Error> {
        let transition = self.world.step(state, action)?;
        if let Some(recording) = &mut self.underway {
            recording.actions.push(action as u32);
        }
        if !matches!(transition.next, Next::Goes(_)) {
            self.finish();
        }
        Ok(transition)
    }
}
