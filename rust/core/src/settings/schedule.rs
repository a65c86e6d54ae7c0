//! The schedules of the learning rate and the exploration rate.

use super::SettingSource;
use crate::StopFlag;
use crate::memory::AllocationError;
use crate::schedules::{LearningRate, Schedule};

/// A rate that changes from episode to episode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ScheduleSpec {
    /// The same in every episode.
    Constant {
        /// The rate.
        value: f64,
    },
    /// Falls by equal amounts.
    Linear {
        /// The rate of the first episodes.
        value: f64,
        /// The rate at the end of the run.
        minimum: f64,
        /// The number of episodes before it begins to fall.
        warm_up: u64,
    },
    /// Falls by a factor after each episode.
    Exponential {
        /// The rate of the first episodes.
        value: f64,
        /// The lowest rate.
        minimum: f64,
        /// The factor.
        decay: f64,
        /// The number of episodes before it begins to fall.
        warm_up: u64,
    },
}

/// A learning rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LearningRateSpec {
    /// A rate that depends only on the episode.
    Schedule(ScheduleSpec),
    /// `value` / n at the n-th visit of a state-action pair, but not below `minimum`.
    Visits {
        /// The rate of the first visit.
        value: f64,
        /// The lowest rate.
        minimum: f64,
    },
}

/// Every schedule of the learning rate by its name; the exploration rate supports all but the last.
pub const SCHEDULES: [(&str, ScheduleKind); 4] = [
    ("constant", ScheduleKind::Constant),
    ("linear", ScheduleKind::Linear),
    ("exponential", ScheduleKind::Exponential),
    ("visits", ScheduleKind::Visits),
];

/// A kind of schedule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScheduleKind {
    /// [`ScheduleSpec::Constant`]
    Constant,
    /// [`ScheduleSpec::Linear`]
    Linear,
    /// [`ScheduleSpec::Exponential`]
    Exponential,
    /// [`LearningRateSpec::Visits`]
    Visits,
}

impl ScheduleSpec {
    /// The same rate in every episode.
    pub const fn constant(value: f64) -> Self {
        Self::Constant { value }
    }

    /// A rate that falls by equal amounts to `minimum`, over all episodes of the run.
    pub const fn linear(value: f64, minimum: f64) -> Self {
        Self::Linear { value, minimum, warm_up: 0 }
    }

    /// A rate that is multiplied by `decay` after each episode, down to `minimum`.
    pub const fn exponential(value: f64, minimum: f64, decay: f64) -> Self {
        Self::Exponential { value, minimum, decay, warm_up: 0 }
    }

    /// The exploration rate ε of a run of `episodes` episodes.
    ///
    /// # Errors
    /// If a setting is missing or invalid.
    pub(super) fn epsilon<S: SettingSource>(settings: &S, episodes: u64) -> Result<Self, S::Error> {
        let names = ["epsilon", "min_epsilon", "epsilon_decay", "epsilon_warm_up"];
        Self::parse(settings, settings.word("epsilon_schedule", &SCHEDULES[..3])?, names, 1.0, episodes)
    }

    /// The schedule from the settings with these names: rate, minimum, decay and warm-up.
    fn parse<S: SettingSource>(
        settings: &S,
        kind: ScheduleKind,
        [value, minimum, decay, warm_up]: [&'static str; 4],
        most: f64,
        episodes: u64,
    ) -> Result<Self, S::Error> {
        let value = settings.number(value, 0.0, most)?;
        if kind == ScheduleKind::Constant {
            return Ok(Self::Constant { value });
        }
        let minimum = settings.number(minimum, 0.0, value)?;
        let warm_up = settings.integer(warm_up, 0, episodes.saturating_sub(1))?;
        if kind == ScheduleKind::Linear {
            return Ok(Self::Linear { value, minimum, warm_up });
        }
        Ok(Self::Exponential { value, minimum, decay: settings.number(decay, 0.0, 1.0)?, warm_up })
    }

    /// The schedule of a run of `episodes` episodes.
    pub fn build(&self, episodes: u64) -> Schedule {
        match *self {
            Self::Constant { value } => Schedule::constant(value),
            Self::Linear { value, minimum, warm_up } => Schedule::linear(value, minimum, episodes, warm_up),
            Self::Exponential { value, minimum, decay, warm_up } => {
                Schedule::exponential(value, minimum, decay, warm_up)
            }
        }
    }
}

/// The same rate in every episode.
impl From<f64> for ScheduleSpec {
    fn from(value: f64) -> Self {
        Self::constant(value)
    }
}

/// The same learning rate in every episode.
impl From<f64> for LearningRateSpec {
    fn from(value: f64) -> Self {
        Self::Schedule(value.into())
    }
}

impl From<ScheduleSpec> for LearningRateSpec {
    fn from(schedule: ScheduleSpec) -> Self {
        Self::Schedule(schedule)
    }
}

impl LearningRateSpec {
    /// `initial` / n at the n-th visit of a state-action pair, but not below `minimum`.
    pub const fn by_visit_count(initial: f64, minimum: f64) -> Self {
        Self::Visits { value: initial, minimum }
    }

    /// The learning rate of a run of `episodes` episodes, at most `most`.
    ///
    /// # Errors
    /// If a setting is missing or invalid.
    pub(super) fn parse<S: SettingSource>(settings: &S, most: f64, episodes: u64) -> Result<Self, S::Error> {
        let names = ["learning_rate", "min_learning_rate", "learning_rate_decay", "learning_rate_warm_up"];
        let kind = settings.word("learning_rate_schedule", &SCHEDULES)?;
        if kind == ScheduleKind::Visits {
            let value = settings.number(names[0], 0.0, most)?;
            return Ok(Self::Visits { value, minimum: settings.number(names[1], 0.0, value)? });
        }
        ScheduleSpec::parse(settings, kind, names, most, episodes).map(Self::Schedule)
    }

    /// The learning rate of a table of so many weights, of which `n_active` share it.
    ///
    /// # Errors
    /// If the counts of the visits do not fit into memory.
    pub fn build(
        &self,
        episodes: u64,
        weights: usize,
        n_active: usize,
        stop: &StopFlag<'_>,
    ) -> Result<LearningRate, AllocationError> {
        match *self {
            Self::Schedule(schedule) => Ok(LearningRate::scheduled(schedule.build(episodes), n_active)),
            Self::Visits { value, minimum } => LearningRate::by_visit_count(value, minimum, weights, n_active, stop),
        }
    }

    /// The learning rate of weighted features: that of each row is divided by its number, if there are any. `None` for a
    /// learning rate by visits, which are those of single rows.
    pub fn build_weighted(&self, episodes: u64, divisors: Vec<f64>) -> Option<LearningRate> {
        let Self::Schedule(schedule) = *self else { return None };
        let schedule = schedule.build(episodes);
        Some(if divisors.is_empty() {
            LearningRate::scheduled(schedule, 1)
        } else {
            LearningRate::scaled_by_row(schedule, divisors)
        })
    }
}
