//! What Gymnasium's environments say besides, batched as `VectorEnv._add_info` batches it: for each name an array, and
//! under the name with an underscore which sub-environments said it.

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use qtab_core::Env;
use qtab_core::VectorEnv;

use super::observations::Shows;

/// How the environments of one type appear in Gymnasium.
pub(super) struct Nature<E: Env> {
    /// So many sub-environments keep a thread busy for long enough to be worth its start.
    pub(super) crew: usize,
    /// What they say of themselves, if anything.
    pub(super) says: Option<Says<E::State>>,
    /// Puts a state, and the action that led to it, into Gymnasium's attributes.
    pub(super) portray: Portray<E>,
    /// What is 0 once an episode has come to a terminal state.
    pub(super) fell: Option<&'static str>,
}

impl<E: Env> Nature<E> {
    /// Of those that say nothing.
    pub(super) fn new(crew: usize, portray: Portray<E>) -> Self {
        Self { crew, says: None, portray, fell: None }
    }
}

pub(super) type Portray<E> = fn(&Bound<'_, PyDict>, &E, &<E as Env>::State, Option<<E as Env>::Action>) -> PyResult<()>;

/// A table's info.
pub(super) struct Says<S> {
    /// How likely the last step was.
    pub(super) probability: fn(&S) -> f64,
    /// Whether a reset's probability is an integer 1.
    pub(super) whole: bool,
    /// For each cell of the table which actions change it, and the cell of a state.
    pub(super) masks: Option<Masks<S>>,
}

pub(super) struct Masks<S> {
    pub(super) table: Vec<[i8; 6]>,
    pub(super) cell: fn(&S) -> usize,
}

pub(super) struct Infos<'py> {
    py: Python<'py>,
    size: usize,
    pub(super) dict: Bound<'py, PyDict>,
}

impl<'py> Infos<'py> {
    pub(super) fn new(py: Python<'py>, size: usize) -> Self {
        Self { py, size, dict: PyDict::new(py) }
    }

    /// After a step everyone has something to say.
    pub(super) fn step<E: Env>(&self, vector: &VectorEnv<E>, nature: &Nature<E>) -> PyResult<()> {
        let Some(says) = &nature.says else { return Ok(()) };
        self.say(&self.dict, says, vector.states().enumerate(), false)
    }

    /// After a reset those have that were reset.
    pub(super) fn reset<E: Env>(&self, vector: &VectorEnv<E>, nature: &Nature<E>, lanes: &[usize]) -> PyResult<()> {
        let Some(says) = &nature.says else { return Ok(()) };
        let states = lanes.iter().map(|&lane| (lane, vector.state(lane)));
        self.say(&self.dict, says, states, says.whole)
    }

    /// What was seen last of the episodes that ended and began anew in the same step.
    pub(super) fn finals<E: Env<Observation: Shows>>(&self, vector: &VectorEnv<E>, nature: &Nature<E>) -> PyResult<()> {
        if vector.final_states().next().is_none() {
            return Ok(());
        }
        let (py, size) = (self.py, self.size);
        let last = PyArray1::<Py<PyAny>>::from_iter(py, (0..size).map(|_| py.None()));
        for (lane, state) in vector.final_states() {
            last.try_readwrite()?.as_slice_mut()?[lane] = vector.env().observe(state).alone(py)?.unbind();
        }
        let infos = PyDict::new(py);
        if let Some(says) = &nature.says {
            self.say(&infos, says, vector.final_states(), false)?;
        }
        self.dict.set_item(intern!(py, "final_obs"), last)?;
        self.dict.set_item(intern!(py, "_final_obs"), self.mask(vector.final_states().map(|(lane, _)| lane)))?;
        self.dict.set_item(intern!(py, "final_info"), infos)?;
        self.dict.set_item(intern!(py, "_final_info"), self.mask(vector.final_states().map(|(lane, _)| lane)))
    }

    fn say<'a, S: 'a>(
        &self,
        dict: &Bound<'py, PyDict>,
        says: &Says<S>,
        states: impl Iterator<Item = (usize, &'a S)> + Clone,
        whole: bool,
    ) -> PyResult<()> {
        let (py, size) = (self.py, self.size);
        let mask = || self.mask(states.clone().map(|(lane, _)| lane));
        let mut likely = vec![0.0; size];
        states.clone().for_each(|(lane, state)| likely[lane] = (says.probability)(state));
        let name = intern!(py, "prob");
        if whole {
            dict.set_item(name, PyArray1::from_iter(py, likely.into_iter().map(|number| number as i64)))?;
        } else {
            dict.set_item(name, PyArray1::from_vec(py, likely))?;
        }
        dict.set_item(intern!(py, "_prob"), mask())?;
        if let Some(Masks { table, cell }) = &says.masks {
            let rows = PyArray2::<i8>::zeros(py, [size, 6], false);
            {
                let mut places = rows.try_readwrite()?;
                let (places, _) = places.as_slice_mut()?.as_chunks_mut::<6>();
                states.clone().for_each(|(lane, state)| places[lane] = table[cell(state)]);
            }
            dict.set_item(intern!(py, "action_mask"), rows)?;
            dict.set_item(intern!(py, "_action_mask"), mask())?;
        }
        Ok(())
    }

    fn mask(&self, lanes: impl Iterator<Item = usize>) -> Bound<'py, PyArray1<bool>> {
        let mut mask = vec![false; self.size];
        lanes.for_each(|lane| mask[lane] = true);
        PyArray1::from_vec(self.py, mask)
    }
}
