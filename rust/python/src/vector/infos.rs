//! The infos of sub-environments, batched as in `VectorEnv._add_info`: an array for each name and, under the name with
//! a leading underscore, a mask of the sub-environments that have the info.

use numpy::{PyArray1, PyArrayMethods};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use qtab_core::memory::{collect, filled};
use qtab_core::vector::States;
use qtab_core::{Env, StopFlag, VectorEnv};

use crate::convert::{array_from, array_of, rows_array};
use crate::error::allocation;

/// The properties of an environment type, besides its dynamics, that a vector environment needs.
pub(crate) struct EnvInfo<E: Env> {
    /// The number of sub-environments per thread from which a step takes long enough to be worth starting the thread.
    pub(crate) envs_per_thread: usize,
    /// The infos of its transitions, if it has any.
    pub(crate) transition: Option<TransitionInfo<E::State>>,
    /// Writes a state, and the action that led to it, into a dict of Gymnasium's attributes.
    pub(crate) snapshot: Snapshot<E>,
    /// The attribute that is 0 after an episode has reached a terminal state.
    pub(crate) terminal_counter: Option<&'static str>,
}

pub(crate) type Snapshot<E> =
    fn(&Bound<'_, PyDict>, &E, &<E as Env>::State, Option<<E as Env>::Action>) -> PyResult<()>;

/// The infos of an environment with finitely many states.
pub(crate) struct TransitionInfo<S> {
    /// The probability of the last transition.
    pub(crate) probability: fn(&S) -> f64,
    /// Whether the probability after a reset is an integer 1.
    pub(crate) integer_after_reset: bool,
    pub(crate) action_masks: Option<ActionMasks<S>>,
}

/// For each state of the table, the actions that change it.
pub(crate) struct ActionMasks<S> {
    pub(crate) masks: Vec<[i8; 6]>,
    /// The index of a state in the table.
    pub(crate) index: fn(&S) -> usize,
}

/// The infos of one call, under construction.
pub(crate) struct Infos<'py> {
    py: Python<'py>,
    num_envs: usize,
    pub(crate) dict: Bound<'py, PyDict>,
}

impl<'py> Infos<'py> {
    pub(crate) fn new(py: Python<'py>, num_envs: usize) -> Self {
        Self { py, num_envs, dict: PyDict::new(py) }
    }

    /// Adds the infos of the sub-environments with these indices after a reset.
    pub(super) fn add_reset<E: Env, S: States<E>>(
        &self,
        envs: &VectorEnv<E, S>,
        info: &EnvInfo<E>,
        indices: &[usize],
    ) -> PyResult<()> {
        let Some(transition) = &info.transition else { return Ok(()) };
        let states = indices.iter().map(|&index| (index, envs.state(index)));
        self.add_transition(&self.dict, transition, states, transition.integer_after_reset)
    }

    /// Adds the final observations and infos of the episodes that ended and were reset in the same step.
    pub(crate) fn add_final(
        &self,
        observations: impl Iterator<Item = PyResult<(usize, Bound<'py, PyAny>)>>,
        infos: &Bound<'py, PyDict>,
    ) -> PyResult<()> {
        let (py, mut mask) = (self.py, repeated(false, self.num_envs)?);
        let array = PyArray1::from_vec(py, collect((0..self.num_envs).map(|_| py.None())).map_err(allocation)?);
        for observation in observations {
            let (index, observation) = observation?;
            array.try_readwrite()?.as_slice_mut()?[index] = observation.unbind();
            mask[index] = true;
        }
        self.dict.set_item(intern!(py, "final_obs"), array)?;
        self.dict.set_item(intern!(py, "_final_obs"), array_from(py, &mask)?)?;
        self.dict.set_item(intern!(py, "final_info"), infos)?;
        self.dict.set_item(intern!(py, "_final_info"), PyArray1::from_vec(py, mask))
    }

    /// Adds the infos of these sub-environments after a step: their indices and states.
    pub(super) fn add_step<E: Env>(
        &self,
        dict: &Bound<'py, PyDict>,
        info: &EnvInfo<E>,
        states: impl Iterator<Item = (usize, E::State)> + Clone,
    ) -> PyResult<()> {
        let Some(transition) = &info.transition else { return Ok(()) };
        self.add_transition(dict, transition, states, false)
    }

    fn add_transition<S>(
        &self,
        dict: &Bound<'py, PyDict>,
        info: &TransitionInfo<S>,
        states: impl Iterator<Item = (usize, S)> + Clone,
        as_integers: bool,
    ) -> PyResult<()> {
        let (py, num_envs) = (self.py, self.num_envs);
        let mask = || self.mask(states.clone().map(|(index, _)| index));
        let mut probabilities = repeated(0.0, num_envs)?;
        states.clone().for_each(|(index, state)| probabilities[index] = (info.probability)(&state));
        let name = intern!(py, "prob");
        if as_integers {
            dict.set_item(name, array_of(py, probabilities.into_iter().map(|number| number as i64))?)?;
        } else {
            dict.set_item(name, PyArray1::from_vec(py, probabilities))?;
        }
        dict.set_item(intern!(py, "_prob"), mask()?)?;
        if let Some(ActionMasks { masks, index: index_of }) = &info.action_masks {
            let mut rows = repeated([0_i8; 6], num_envs)?;
            states.clone().for_each(|(index, state)| rows[index] = masks[index_of(&state)]);
            dict.set_item(intern!(py, "action_mask"), rows_array(py, &rows)?)?;
            dict.set_item(intern!(py, "_action_mask"), mask()?)?;
        }
        Ok(())
    }

    /// The mask of the sub-environments with these indices.
    pub(crate) fn mask(&self, indices: impl Iterator<Item = usize>) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let mut mask = repeated(false, self.num_envs)?;
        indices.for_each(|index| mask[index] = true);
        Ok(PyArray1::from_vec(self.py, mask))
    }
}

/// This many copies of a value.
pub(crate) fn repeated<T: Clone>(value: T, count: usize) -> PyResult<Vec<T>> {
    filled(&value, count, &StopFlag::new()).map_err(allocation)
}
