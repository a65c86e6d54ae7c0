//! A trial of an environment's functions.

use std::collections::TryReserveError;
use std::error::Error;
use std::fmt::{self, Display, Formatter};
use std::time::{Duration, Instant};

use super::{BitGenerator, CallError, Ending, Environment, Episode, RandomBits};
use crate::Number;
use crate::table::{FLOAT32, FLOAT64};

/// The time after which a trial takes no further step.
const LONGEST: Duration = Duration::from_secs(1);

/// A rule of the interface that a function broke in a trial.
#[derive(Clone, Debug, PartialEq)]
pub enum TrialError {
    /// The memory for an episode does not suffice.
    OutOfMemory,
    /// A call without a result.
    Call(CallError),
    /// A function wrote beyond the end of the buffer of this name.
    Overrun(&'static str),
    /// `step` changed the state that it reads.
    StateChanged,
    /// A number of an observation outside its bounds, or not a number.
    Observation {
        /// The function that wrote it.
        function: &'static str,
        /// The index of the number.
        index: usize,
        /// The number.
        value: f64,
        /// The bounds.
        bounds: (f64, f64),
    },
    /// An action mask of other numbers than 0 and 1, or of zeros.
    ActionMask {
        /// The function that wrote it.
        function: &'static str,
        /// The numbers.
        mask: Vec<u8>,
    },
    /// `observe` wrote another observation or action mask than the function before it.
    Observe(&'static str),
    /// `step` gave another result for the same state, action and generator.
    Repeat,
}

impl Display for TrialError {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfMemory => write!(formatter, "its state and observation do not fit into memory"),
            Self::Call(error) => error.fmt(formatter),
            Self::Overrun(name) => write!(formatter, "a function wrote beyond the end of {name}"),
            Self::StateChanged => write!(formatter, "step changed state, which it may only read"),
            Self::Observation { function, index, value, bounds: (low, high) } => write!(
                formatter,
                "{function} must write numbers from observation_low to observation_high, got {value} as \
                 observation[{index}], which has the bounds {low} and {high}"
            ),
            Self::ActionMask { function, mask } => {
                write!(formatter, "{function} must write an action mask of 0 and 1 with at least one 1, got {mask:?}")
            }
            Self::Observe(what) => {
                write!(formatter, "observe must write the same {what} as reset and step, but wrote another one")
            }
            Self::Repeat => write!(
                formatter,
                "step must give the same result for the same state, action and random numbers, but gave another one: it \
                 may keep nothing between two calls"
            ),
        }
    }
}

impl Error for TrialError {}

impl From<CallError> for TrialError {
    fn from(error: CallError) -> Self {
        Self::Call(error)
    }
}

impl From<TryReserveError> for TrialError {
    fn from(_: TryReserveError) -> Self {
        Self::OutOfMemory
    }
}

/// Plays `steps` steps with random actions, drawn from `rng`, and checks after each call what the functions have written.
/// It stops after a second, as a step may take long.
///
/// # Errors
/// The first rule that a function broke.
pub fn try_out(
    environment: &Environment,
    steps: usize,
    rng: &mut (impl BitGenerator + Clone),
) -> Result<(), TrialError> {
    match environment.observation_type() {
        FLOAT32 => Trial::<f32>::new(environment)?.play(steps, rng),
        FLOAT64 => Trial::<f64>::new(environment)?.play(steps, rng),
        _ => Trial::<i64>::new(environment)?.play(steps, rng),
    }
}

/// An episode, and copies of what its last call wrote.
struct Trial<'a, T> {
    episode: Episode<&'a Environment>,
    state: Vec<u8>,
    observation: Vec<T>,
    action_mask: Vec<u8>,
}

impl<'a, T: Number> Trial<'a, T> {
    fn new(environment: &'a Environment) -> Result<Self, TryReserveError> {
        let episode = Episode::new(environment)?;
        Ok(Self { episode, state: Vec::new(), observation: Vec::new(), action_mask: Vec::new() })
    }

    fn play(&mut self, steps: usize, rng: &mut (impl BitGenerator + Clone)) -> Result<(), TrialError> {
        let mut actions = rng.clone();
        let limit = self.episode.environment().max_episode_steps().unwrap_or(u64::MAX);
        let (mut is_over, mut elapsed) = (true, 0);
        let start = Instant::now();
        for _ in 0..steps {
            if start.elapsed() > LONGEST {
                break;
            }
            if is_over {
                self.episode.reset(&mut RandomBits::new(rng))?;
                self.check("reset", false)?;
                elapsed = 0;
            }
            let action = self.choose(&mut actions);
            let before = (self.episode.state().to_vec(), rng.clone());
            let result = self.episode.step(action, &mut RandomBits::new(rng))?;
            elapsed += 1;
            is_over = result.1 != Ending::Continues || elapsed >= limit;
            self.check("step", result.1 == Ending::Terminated)?;
            let (state, mut same_rng) = before;
            self.repeat(&state, action, &mut same_rng, result)?;
        }
        Ok(())
    }

    /// An available action, at random.
    fn choose(&self, rng: &mut impl BitGenerator) -> usize {
        let environment = self.episode.environment();
        let is_available = |&action: &usize| !environment.has_action_mask() || self.action_mask[action] == 1;
        let count = (0..environment.num_actions()).filter(is_available).count();
        let chosen = (rng.next_u64() % count.max(1) as u64) as usize;
        (0..environment.num_actions()).filter(is_available).nth(chosen).unwrap_or(0)
    }

    /// Checks what a function wrote, and that `observe` writes the same.
    fn check(&mut self, function: &'static str, is_terminal: bool) -> Result<(), TrialError> {
        self.check_written(function, is_terminal)?;
        self.copy();
        self.episode.observe()?;
        self.check_written("observe", is_terminal)?;
        if self.state != self.episode.state() {
            return Err(TrialError::StateChanged);
        }
        if self.observation != self.episode.observation::<T>() {
            return Err(TrialError::Observe("observation"));
        }
        let has_action_mask = self.episode.environment().has_action_mask();
        if has_action_mask && !is_terminal && self.action_mask != self.episode.action_mask() {
            return Err(TrialError::Observe("action mask"));
        }
        Ok(())
    }

    fn check_written(&self, function: &'static str, is_terminal: bool) -> Result<(), TrialError> {
        if let Some(buffer) = self.episode.overrun() {
            return Err(TrialError::Overrun(buffer));
        }
        let environment = self.episode.environment();
        for (index, number) in self.episode.observation::<T>().iter().enumerate() {
            let (value, bounds) = (number.to_f64(), (environment.low(index), environment.high(index)));
            if !(number.is_finite() && bounds.0 <= value && value <= bounds.1) {
                return Err(TrialError::Observation { function, index, value, bounds });
            }
        }
        let mask = self.episode.action_mask();
        let is_mask = mask.iter().all(|&byte| byte <= 1) && (is_terminal || mask.contains(&1));
        if environment.has_action_mask() && !is_mask {
            return Err(TrialError::ActionMask { function, mask: mask.to_vec() });
        }
        Ok(())
    }

    fn copy(&mut self) {
        self.state = self.episode.state().to_vec();
        self.observation = self.episode.observation().to_vec();
        self.action_mask = self.episode.action_mask().to_vec();
    }

    /// Takes the last step again, from the state before it, and then continues after it.
    fn repeat(
        &mut self,
        state: &[u8],
        action: usize,
        rng: &mut impl BitGenerator,
        result: (f64, Ending),
    ) -> Result<(), TrialError> {
        self.episode.set_state(state);
        let again = self.episode.step(action, &mut RandomBits::new(rng))?;
        if self.episode.previous_state() != state {
            return Err(TrialError::StateChanged);
        }
        let is_same = again == result && self.observation == self.episode.observation::<T>();
        if is_same { Ok(()) } else { Err(TrialError::Repeat) }
    }
}
