//! The actions available in each state, as far as they are known before the first episode.

use std::sync::Arc;

use numpy::PyReadonlyArrayDyn;
use pyo3::prelude::*;
use qtab_core::StopFlag;
use qtab_core::learners::ActionMasks;
use qtab_core::memory::collect;

use super::fields::{Fields, Variant};
use crate::error::{allocation, invalid};

#[derive(Clone, Debug)]
pub(crate) enum ActionMasksSpec {
    /// Every state has all actions.
    None,
    /// The environment provides the mask of each observation.
    Observed,
    /// The masks of all rows, shared between runs.
    Known(Arc<Vec<bool>>),
}

const ACTION_MASKS: &[Variant<ActionMasksSpec>] = &[
    ("none", |_| Ok(ActionMasksSpec::None)),
    ("observed", |_| Ok(ActionMasksSpec::Observed)),
    ("known", |fields| {
        let available: PyReadonlyArrayDyn<'_, bool> = fields.get("available")?;
        let available = collect(available.as_array().iter().copied()).map_err(allocation)?;
        Ok(ActionMasksSpec::Known(Arc::new(available)))
    }),
];

impl ActionMasksSpec {
    pub(crate) fn parse(fields: &Fields<'_>) -> PyResult<Self> {
        fields.tagged(ACTION_MASKS)
    }

    pub(crate) fn is_none(&self) -> bool {
        matches!(self, Self::None)
    }

    /// The masks of a table before the first episode.
    pub(crate) fn build(
        &self,
        (rows, num_actions): (usize, usize),
        n_active: usize,
        stop: &StopFlag<'_>,
    ) -> PyResult<Option<Box<ActionMasks>>> {
        let masks = match self {
            Self::None => return Ok(None),
            Self::Observed => ActionMasks::new(rows, num_actions, n_active, stop).map_err(allocation)?,
            Self::Known(available) => {
                if available.len() != rows * num_actions {
                    let expected = format!("{rows} rows of {num_actions} booleans");
                    return Err(invalid("action_masks.available", expected, format!("{} booleans", available.len())));
                }
                ActionMasks::known(collect(available.iter().copied()).map_err(allocation)?, num_actions)
            }
        };
        Ok(Some(Box::new(masks)))
    }
}
