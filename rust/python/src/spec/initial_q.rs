//! The action values before the first episode.

use std::iter::repeat;
use std::sync::Arc;

use numpy::PyReadonlyArrayDyn;
use pyo3::prelude::*;
use qtab_core::QTable;
use qtab_core::StopFlag;
use qtab_core::learners::ActionMasks;
use qtab_core::memory::{collect, filled, from_fn};
use qtab_core::random::{NoRng, Rng};
use qtab_core::settings::SettingSource;

use super::fields::Fields;
use crate::error::{allocation, invalid};

#[derive(Clone, Debug)]
pub(crate) enum InitialQSpec {
    /// The values of all tables, in C order, shared between runs.
    Given(Arc<Vec<f64>>),
    Uniform {
        low: f64,
        high: f64,
    },
    Constant {
        value: f64,
    },
}

impl InitialQSpec {
    pub(crate) fn parse(fields: &Fields<'_>) -> PyResult<Self> {
        let given = fields.any("initial_q")?;
        // Arrays first: an array of a single value also extracts as a number.
        if let Ok(values) = given.extract::<PyReadonlyArrayDyn<'_, f64>>() {
            return Ok(Self::Given(Arc::new(collect(values.as_array().iter().copied()).map_err(allocation)?)));
        }
        if let Ok((low, high)) = given.extract() {
            return Ok(Self::Uniform { low, high });
        }
        let value =
            given.extract().map_err(|_| fields.invalid("initial_q", "a number, a range or an array of float64"))?;
        Ok(Self::Constant { value })
    }

    /// Whether some states lack actions, marked by an initial value of -∞.
    pub(crate) fn has_masked_actions(&self) -> bool {
        matches!(self, Self::Given(values) if values.contains(&f64::NEG_INFINITY))
    }

    /// Whether these tables hold values that are not finite, other than the initial -∞ of missing actions.
    pub(crate) fn has_overflowed(&self, tables: &[&[f64]]) -> bool {
        let initial = if let Self::Given(values) = self { &values[..] } else { &[] };
        let pairs = tables.iter().copied().flatten().zip(initial.iter().chain(repeat(&0.0)));
        let missing = |value: f64, initial: f64| value == f64::NEG_INFINITY && initial == f64::NEG_INFINITY;
        !pairs.into_iter().all(|(&value, &initial)| value.is_finite() || missing(value, initial))
    }

    /// The missing actions as masks, for learners that need them in addition to the values; None if no state lacks an
    /// action.
    pub(crate) fn masks(&self, size: usize, num_actions: usize) -> PyResult<Option<Box<ActionMasks>>> {
        match self {
            Self::Given(values) if self.has_masked_actions() => {
                let first_table = values.iter().take(size).map(|value| *value != f64::NEG_INFINITY);
                let available = collect(first_table).map_err(allocation)?;
                Ok(Some(Box::new(ActionMasks::known(available, num_actions))))
            }
            _ => Ok(None),
        }
    }

    /// The table of state values beside a table of preferences: all 0, unless both tables are given.
    pub(crate) fn critic_table(&self, shape: (usize, usize), stop: &StopFlag<'_>) -> PyResult<QTable> {
        match self {
            Self::Given(_) => self.table((1, 2), shape, &mut NoRng, stop),
            _ => (Self::Constant { value: 0.0 }).table((0, 1), shape, &mut NoRng, stop),
        }
    }

    /// Table `index` of `n_tables`, as it is before the first episode.
    pub(crate) fn table<const N: usize>(
        &self,
        (index, n_tables): (usize, usize),
        (n_rows, num_actions): (usize, usize),
        rng: &mut impl Rng,
        stop: &StopFlag<'_>,
    ) -> PyResult<QTable<N>> {
        let size = n_rows * num_actions;
        let values = match self {
            Self::Given(values) => {
                if values.len() != n_tables * size {
                    let expected = format!("{n_tables} tables of {n_rows} rows of {num_actions} values");
                    return Err(invalid("initial_q", expected, format!("{} values", values.len())));
                }
                let mut values = values[index * size..][..size].iter();
                from_fn(size, stop, || values.next().copied().unwrap_or_default())
            }
            Self::Constant { value } => filled(value, size, stop),
            Self::Uniform { low, high } => from_fn(size, stop, || rng.uniform(*low, *high)),
        };
        Ok(QTable::new(values.map_err(allocation)?, num_actions))
    }
}
