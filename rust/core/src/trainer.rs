//! A run as a value: all that it needs to go on, and the only training loop.

use crate::learner::Learner;
use crate::random::Draw;
use crate::world::{Next, World};

/// Where `advance` stops, whichever comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Until {
    /// This many episodes are finished, counted from the run's beginning.
    pub episodes: usize,
    /// This many steps have been taken, counted from the call.
    pub steps: u64,
}

/// What the finished episodes brought.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Episodes {
    /// The sum of rewards of each episode.
    pub returns: Vec<f64>,
    /// The number of steps of each episode.
    pub lengths: Vec<i64>,
    /// Whether each ended in a terminal state, and not by its time limit alone.
    pub terminated: Vec<bool>,
}

/// The unfinished episode.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Underway<S, R> {
    pub(crate) state: S,
    pub(crate) here: R,
    pub(crate) action: usize,
    pub(crate) total: f64,
    pub(crate) length: i64,
}

/// A world, a learner and the agent's stream.
#[derive(Clone, Debug)]
pub struct Trainer<W: World, L, D> {
    pub(crate) world: W,
    pub(crate) learner: L,
    pub(crate) draw: D,
    pub(crate) episodes: Episodes,
    pub(crate) underway: Option<Underway<W::State, W::Rows>>,
}

impl<W: World, L: Learner<W::Rows>, D: Draw + Clone> Trainer<W, L, D> {
    /// A run that has not begun.
    pub fn new(world: W, learner: L, draw: D) -> Self {
        Self { world, learner, draw, episodes: Episodes::default(), underway: None }
    }

    /// The world.
    pub fn world(&self) -> &W {
        &self.world
    }

    /// The learner.
    pub fn learner(&self) -> &L {
        &self.learner
    }

    /// The finished episodes.
    pub fn episodes(&self) -> &Episodes {
        &self.episodes
    }

    /// The number, from 0, of the episode underway, or else of the last one finished.
    pub fn last_episode(&self) -> usize {
        let finished = self.episodes.returns.len();
        if self.underway.is_some() { finished } else { finished.saturating_sub(1) }
    }

    /// Goes on until `until`; called again, it goes on as if it had not stopped. A learner that has diverged goes on no
    /// more: it stops after that episode.
    ///
    /// # Errors
    /// The world's. What was learned before stays; the episode in which it happened is not counted.
    pub fn advance(&mut self, until: Until) -> Result<(), W::Error> {
        // The stream and the episode are locals here: behind `self` they would go through memory at every step.
        let mut draw = self.draw.clone();
        let result = self.advance_with(&mut draw, until);
        self.draw = draw;
        result
    }

    #[inline]
    fn advance_with(&mut self, draw: &mut D, until: Until) -> Result<(), W::Error> {
        let mut steps = until.steps;
        while steps > 0 && self.episodes.returns.len() < until.episodes && !self.learner.diverged() {
            let now = match self.underway.take() {
                Some(now) => now,
                None => self.begin(draw)?,
            };
            let Underway { mut state, mut here, mut action, mut total, mut length } = now;
            loop {
                let transition = self.world.step(&mut state, action)?;
                total += transition.reward;
                length += 1;
                steps -= 1;
                action = self.learner.learn(here, action, transition.reward, transition.next, draw);
                match transition.next {
                    Next::Goes(there) => here = there,
                    Next::TimedOut(_) => {
                        self.finish(total, length, false);
                        break;
                    }
                    Next::Terminal => {
                        self.finish(total, length, true);
                        break;
                    }
                }
                if steps == 0 {
                    self.underway = Some(Underway { state, here, action, total, length });
                    break;
                }
            }
        }
        Ok(())
    }

    pub(crate) fn begin(&mut self, draw: &mut impl Draw) -> Result<Underway<W::State, W::Rows>, W::Error> {
        let (state, here) = self.world.reset()?;
        Ok(Underway { state, here, action: self.learner.begin(here, draw), total: 0.0, length: 0 })
    }

    pub(crate) fn finish(&mut self, total: f64, length: i64, terminated: bool) {
        self.learner.end_episode();
        self.episodes.returns.push(total);
        self.episodes.lengths.push(length);
        self.episodes.terminated.push(terminated);
    }
}
