//! How the learning rate and the exploration rate change during training.

use pyo3::prelude::*;
use qtab_core::schedules::Schedule;

use super::fields::Fields;
use crate::error::invalid;

/// A rate that changes from episode to episode.
#[derive(Clone, Copy, Debug)]
pub(crate) enum ScheduleSpec {
    Constant { value: f64 },
    Linear { value: f64, minimum: f64, warm_up: u64 },
    Exponential { value: f64, minimum: f64, decay: f64, warm_up: u64 },
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum LearningRateSpec {
    Schedule(ScheduleSpec),
    /// `value` / n at the n-th visit of a state-action pair, but not below `minimum`.
    Visits {
        value: f64,
        minimum: f64,
    },
}

/// Parses a schedule of a run of so many episodes.
type Parser = fn(&Fields<'_>, u64) -> PyResult<LearningRateSpec>;

/// Every schedule of the learning rate by its name; the exploration rate has all but the last.
pub(crate) const SCHEDULES: &[(&str, Parser)] =
    &[("constant", constant), ("linear", linear), ("exponential", exponential), ("visits", visits)];

fn constant(fields: &Fields<'_>, _episodes: u64) -> PyResult<LearningRateSpec> {
    Ok(LearningRateSpec::Schedule(ScheduleSpec::Constant { value: fields.get("value")? }))
}

fn linear(fields: &Fields<'_>, episodes: u64) -> PyResult<LearningRateSpec> {
    let warm_up = fields.get("warm_up")?;
    if warm_up >= episodes {
        return Err(invalid(&fields.path("warm_up"), format!("less than the {episodes} episodes"), warm_up));
    }
    let (value, minimum) = (fields.get("value")?, fields.get("minimum")?);
    Ok(LearningRateSpec::Schedule(ScheduleSpec::Linear { value, minimum, warm_up }))
}

fn exponential(fields: &Fields<'_>, _episodes: u64) -> PyResult<LearningRateSpec> {
    Ok(LearningRateSpec::Schedule(ScheduleSpec::Exponential {
        value: fields.get("value")?,
        minimum: fields.get("minimum")?,
        decay: fields.get("decay")?,
        warm_up: fields.get("warm_up")?,
    }))
}

fn visits(fields: &Fields<'_>, _episodes: u64) -> PyResult<LearningRateSpec> {
    Ok(LearningRateSpec::Visits { value: fields.get("value")?, minimum: fields.get("minimum")? })
}

impl ScheduleSpec {
    /// Parses a schedule by the episode, such as the exploration rate's.
    pub(crate) fn parse(fields: &Fields<'_>, episodes: u64) -> PyResult<Self> {
        match LearningRateSpec::parse(fields, episodes)? {
            LearningRateSpec::Schedule(schedule) => Ok(schedule),
            LearningRateSpec::Visits { .. } => {
                Err(invalid(&fields.path("type"), "a schedule by the episode", "'visits'"))
            }
        }
    }

    /// The schedule of a run of that many episodes.
    pub(crate) fn build(&self, episodes: u64) -> Schedule {
        match *self {
            Self::Constant { value } => Schedule::constant(value),
            Self::Linear { value, minimum, warm_up } => Schedule::linear(value, minimum, episodes, warm_up),
            Self::Exponential { value, minimum, decay, warm_up } => {
                Schedule::exponential(value, minimum, decay, warm_up)
            }
        }
    }
}

impl LearningRateSpec {
    pub(crate) fn parse(fields: &Fields<'_>, episodes: u64) -> PyResult<Self> {
        fields.word("type", SCHEDULES)?(fields, episodes)
    }
}
