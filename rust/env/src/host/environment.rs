//! A checked table.

#![expect(unsafe_code, reason = "a table is given by its address")]

use std::ptr;

use super::TableError;
use crate::table::{ENV_VERSION, FLOAT32, FLOAT64, INT64, ObserveFunction, ResetFunction, StepFunction, Table};

/// The largest state, in bytes.
const MAX_STATE_SIZE: u64 = 1 << 30;

/// The largest observation, in numbers.
const MAX_OBSERVATION_SIZE: u32 = 1 << 24;

/// The largest number of actions.
const MAX_ACTIONS: i64 = (1 << 31) - 1;

/// An environment whose table was checked.
#[derive(Clone, Debug)]
pub struct Environment {
    pub(super) table: Table,
    pub(super) reset: ResetFunction,
    pub(super) step: StepFunction,
    pub(super) observe: ObserveFunction,
    low: Option<Vec<f64>>,
    high: Option<Vec<f64>>,
}

// SAFETY: the interface demands that the functions may be called on any thread, and that `parameters` do not change.
unsafe impl Send for Environment {}
// SAFETY: as above.
unsafe impl Sync for Environment {}

impl Environment {
    /// Checks the table at an address.
    ///
    /// # Errors
    /// A field that is wrong.
    ///
    /// # Safety
    /// The address is null, or that of a `qtab_env` of any version: it begins with the version and the size of the
    /// struct. A table with correct fields keeps the rules of `qtab_env.h`, as long as the environment or an episode of
    /// it lives: its functions write only the sizes that it states, and may be called on any thread. Bytes that are
    /// passed to [`Episode::set_state`](super::Episode::set_state) are those of a state of this environment.
    pub unsafe fn new(address: *const Table) -> Result<Self, TableError> {
        if address.is_null() {
            return Err(TableError::Null);
        }
        if !address.is_aligned() {
            return Err(TableError::Misaligned);
        }
        // SAFETY: every version begins with these two numbers.
        let [version, size] = unsafe { address.cast::<[u32; 2]>().read() };
        if version != ENV_VERSION {
            return Err(TableError::Version(version));
        }
        let expected = size_of::<Table>();
        require("struct_size", size as usize == expected, || format!("{expected}, sizeof(qtab_env)"), size)?;
        // SAFETY: the struct has this version and size.
        let table = unsafe { ptr::read(address) };
        check_numbers(&table)?;
        let missing = |name| field(name, "a function", "NULL");
        let reset = table.reset.ok_or_else(|| missing("reset"))?;
        let step = table.step.ok_or_else(|| missing("step"))?;
        let observe = table.observe.ok_or_else(|| missing("observe"))?;
        let is_single = table.observation_type == FLOAT32;
        let bounds = |address: *const f64| -> Option<Vec<f64>> {
            // SAFETY: an address that is not null is that of `observation_size` floats.
            let bounds = (!address.is_null())
                .then(|| unsafe { std::slice::from_raw_parts(address, table.observation_size as usize) });
            let to_type = |&bound: &f64| if is_single { f64::from(bound as f32) } else { bound };
            bounds.map(|bounds| bounds.iter().map(to_type).collect())
        };
        let (low, high) = (bounds(table.observation_low), bounds(table.observation_high));
        let environment = Self { table, reset, step, observe, low, high };
        environment.check_bounds()?;
        Ok(environment)
    }

    fn check_bounds(&self) -> Result<(), TableError> {
        for index in 0..self.observation_size() {
            let (low, high) = (self.low(index), self.high(index));
            require("observation_low", low <= high, || "at most observation_high".into(), format!("{low} > {high}"))?;
            if self.table.observation_type == INT64 {
                let whole = |bound: f64| bound.fract() == 0.0 && bound.abs() <= 9_007_199_254_740_992.0;
                for (name, bound) in [("observation_low", low), ("observation_high", high)] {
                    require(name, whole(bound), || "an integer for QTAB_INT64".into(), bound)?;
                }
            }
        }
        Ok(())
    }

    /// The size of a state in bytes.
    pub fn state_size(&self) -> usize {
        self.table.state_size as usize
    }

    /// [`FLOAT32`], [`FLOAT64`] or [`INT64`].
    pub fn observation_type(&self) -> u32 {
        self.table.observation_type
    }

    /// The number of numbers of an observation.
    pub fn observation_size(&self) -> usize {
        self.table.observation_size as usize
    }

    /// The lowest value of a number of an observation, rounded to its type.
    pub fn low(&self, index: usize) -> f64 {
        self.low.as_ref().map_or(f64::NEG_INFINITY, |low| low[index])
    }

    /// The highest value of a number of an observation, rounded to its type.
    pub fn high(&self, index: usize) -> f64 {
        self.high.as_ref().map_or(f64::INFINITY, |high| high[index])
    }

    /// The number of actions.
    pub fn num_actions(&self) -> usize {
        self.table.num_actions as usize
    }

    /// The time limit in steps.
    pub fn max_episode_steps(&self) -> Option<u64> {
        u64::try_from(self.table.max_episode_steps).ok().filter(|&steps| steps > 0)
    }

    /// Whether the functions write an action mask.
    pub fn has_action_mask(&self) -> bool {
        self.table.has_action_mask == 1
    }
}

/// Checks the sizes and types of a table.
fn check_numbers(table: &Table) -> Result<(), TableError> {
    let Table { state_size, observation_type, observation_size, num_actions, max_episode_steps, .. } = *table;
    let up_to = |least: u32, largest: &dyn std::fmt::Display| format!("from {least} to {largest}");
    require("state_size", state_size <= MAX_STATE_SIZE, || up_to(0, &MAX_STATE_SIZE), state_size)?;
    let is_type = [FLOAT32, FLOAT64, INT64].contains(&observation_type);
    let types = || "QTAB_FLOAT32, QTAB_FLOAT64 or QTAB_INT64".into();
    require("observation_type", is_type, types, observation_type)?;
    let is_size = (1..=MAX_OBSERVATION_SIZE).contains(&observation_size);
    require("observation_size", is_size, || up_to(1, &MAX_OBSERVATION_SIZE), observation_size)?;
    let is_count = (1..=MAX_ACTIONS).contains(&num_actions);
    require("num_actions", is_count, || up_to(1, &MAX_ACTIONS), num_actions)?;
    require("max_episode_steps", max_episode_steps >= 0, || "0 or more".into(), max_episode_steps)?;
    require("has_action_mask", table.has_action_mask <= 1, || "0 or 1".into(), table.has_action_mask)?;
    require("reserved", table.reserved == 0, || "0".into(), table.reserved)
}

fn require(
    name: &'static str,
    is_valid: bool,
    expected: impl FnOnce() -> String,
    got: impl ToString,
) -> Result<(), TableError> {
    if is_valid { Ok(()) } else { Err(field(name, expected(), got)) }
}

#[expect(clippy::needless_pass_by_value, reason = "as for `require`")]
fn field(name: &'static str, expected: impl Into<String>, got: impl ToString) -> TableError {
    TableError::Field { name, expected: expected.into(), got: got.to_string() }
}
