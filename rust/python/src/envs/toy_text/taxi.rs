//! `Taxi-v4`: a table, the fickle passenger and the action mask.

use std::sync::Arc;

use numpy::{PyArrayDescrMethods, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::pyclass::CompareOp;
use pyo3::types::{PyBytes, PyDict, PyTuple};
use qtab_core::envs::toy_text::{Taxi, TaxiState};
use qtab_core::envs::wrappers::{TransitionProbabilityState, WithTransitionProbability};
use qtab_core::planning::Mdp;

use super::super::gymnasium::{generator, render_if_human};
use super::super::native_env::NativeEnv;
use super::sampling::{begin_episode, python_int, reset_fallback, sample_transition, set_snapshot, step_fallback};
use super::table::{identity, table_runs};
use super::transition_table::table_of;
use crate::convert::{discrete_action, small_array};
use crate::runs::{RunFactory, generic};
use crate::spec::RunSpec;
use crate::vector::{ActionMasks, DynVectorEnv, EnvInfo, TransitionInfo, VectorOptions, native_vector_env};

const STATES: usize = 500;
/// The passenger's location once they are in the taxi.
const IN_TAXI: usize = 4;
/// The shape of the map in characters, its border included.
const MAP_SHAPE: [usize; 2] = [7, 11];

/// A taxi, whose table all runs share.
struct TaxiEnv {
    taxi: Taxi,
    /// Gymnasium's environment, which provides the action masks.
    env: Py<PyAny>,
}

pub(crate) fn taxi_env(env: &Bound<'_, PyAny>) -> PyResult<Arc<dyn NativeEnv>> {
    let is_fickle = env.getattr("fickle_passenger")?.is_truthy()?;
    let fickle = if is_fickle { Some(env.getattr("fickle_probability")?.extract()?) } else { None };
    let taxi = Taxi { table: table_of(env)?, fickle };
    Ok(Arc::new(TaxiEnv { taxi, env: env.clone().unbind() }))
}

impl NativeEnv for TaxiEnv {
    fn runs(&self, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        if self.taxi.fickle.is_some() {
            return generic(self.taxi.clone(), identity(&self.taxi.table, spec)?, spec);
        }
        table_runs(self.taxi.table.clone(), spec)
    }

    fn vector_env(&self, py: Python<'_>, options: VectorOptions) -> PyResult<Option<Box<dyn DynVectorEnv>>> {
        let env = self.env.bind(py);
        let mask = |state: usize| env.call_method1(intern!(py, "action_mask"), (state,))?.extract();
        let masks = (0..STATES).map(mask).collect::<PyResult<_>>()?;
        let transition = TransitionInfo {
            probability: |state: &TransitionProbabilityState<TaxiState>| state.probability,
            integer_after_reset: false,
            action_masks: Some(ActionMasks {
                masks,
                index: |state: &TransitionProbabilityState<TaxiState>| state.state.cell as usize,
            }),
        };
        let info = EnvInfo { envs_per_thread: 16_384, transition: Some(transition), snapshot, terminal_counter: None };
        native_vector_env::<_, Vec<_>>(py, WithTransitionProbability(self.taxi.clone()), info, options).map(Some)
    }

    fn mdp(&self) -> PyResult<Option<Mdp>> {
        Mdp::try_from(&self.taxi).map(Some).map_err(|error| PyValueError::new_err(error.to_string()))
    }
}

fn snapshot(
    attributes: &Bound<'_, PyDict>,
    _env: &WithTransitionProbability<Taxi>,
    state: &TransitionProbabilityState<TaxiState>,
    last_action: Option<usize>,
) -> PyResult<()> {
    attributes.set_item(intern!(attributes.py(), "fickle_step"), state.state.fickle)?;
    set_snapshot(attributes, state.state.cell, last_action)
}

/// The base of the Gymnasium-facing class.
#[pyclass(subclass, frozen, name = "Taxi", module = "qtab._core")]
pub(crate) struct PyTaxi;

/// A state of the table, decoded.
#[derive(Clone, Copy)]
struct DecodedState {
    row: usize,
    column: usize,
    passenger: usize,
    destination: usize,
}

impl DecodedState {
    fn new(state: usize) -> Self {
        Self { row: state / 100, column: state / 20 % 5, passenger: state / 4 % 5, destination: state % 4 }
    }
}

#[pymethods]
impl PyTaxi {
    #[new]
    #[pyo3(signature = (*_args, **_kwargs))]
    fn new(_args: &Bound<'_, PyTuple>, _kwargs: Option<&Bound<'_, PyDict>>) -> Self {
        Self
    }

    /// Draws the initial state from the environment's generator; returns the result of `reset`.
    #[pyo3(name = "_native_reset")]
    fn native_reset<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let Some(state) = begin_episode(slf)? else { return reset_fallback(slf) };
        let mut fickle = slf.getattr(intern!(py, "fickle_passenger"))?;
        if fickle.is_truthy()? {
            let random = generator(slf)?.call_method0(intern!(py, "random"))?;
            fickle = random.rich_compare(slf.getattr(intern!(py, "fickle_probability"))?, CompareOp::Lt)?;
        }
        slf.setattr(intern!(py, "fickle_step"), fickle)?;
        slf.setattr(intern!(py, "taxi_orientation"), 0)?;
        render_if_human(slf)?;
        let info = PyDict::new(py);
        info.set_item(intern!(py, "prob"), 1.0)?;
        info.set_item(intern!(py, "action_mask"), slf.call_method1(intern!(py, "action_mask"), (&state,))?)?;
        Ok((python_int(state)?, info).into_pyobject(py)?.into_any())
    }

    /// One step, with Gymnasium's return types.
    fn step<'py>(slf: &Bound<'py, Self>, action: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let state = slf.getattr_opt(intern!(py, "s"))?;
        let before = state.as_ref().and_then(|state| discrete_action(state, STATES)).map(DecodedState::new);
        if state.is_some() && before.is_none() {
            return step_fallback(slf, action);
        }
        let sampled = sample_transition(slf, action, |state| discrete_action(state, STATES).is_some())?;
        let (Some(mut sampled), Some(before)) = (sampled, before) else { return step_fallback(slf, action) };
        slf.setattr(intern!(py, "lastaction"), action)?;
        if let Some(after) = discrete_action(&sampled.state, STATES).map(DecodedState::new)
            && slf.getattr(intern!(py, "fickle_passenger"))?.is_truthy()?
            && slf.getattr(intern!(py, "fickle_step"))?.is_truthy()?
            && before.passenger == IN_TAXI
            && (after.row, after.column) != (before.row, before.column)
        {
            slf.setattr(intern!(py, "fickle_step"), false)?;
            let locations = slf.getattr(intern!(py, "locs"))?.len()?;
            let others: Vec<usize> = (0..locations).filter(|&location| location != before.destination).collect();
            let destination = generator(slf)?.call_method1(intern!(py, "choice"), (others,))?;
            let decoded = (after.row, after.column, after.passenger, destination);
            sampled.state = slf.call_method1(intern!(py, "encode"), decoded)?;
        }
        slf.setattr(intern!(py, "s"), &sampled.state)?;
        render_if_human(slf)?;
        let info = PyDict::new(py);
        info.set_item(intern!(py, "prob"), sampled.probability)?;
        info.set_item(intern!(py, "action_mask"), slf.call_method1(intern!(py, "action_mask"), (&sampled.state,))?)?;
        let answer = (python_int(sampled.state)?, sampled.reward, sampled.terminated, false, info);
        Ok(answer.into_pyobject(py)?.into_any())
    }

    /// (6,) int8: 1 for the actions that change the state.
    fn action_mask<'py>(slf: &Bound<'py, Self>, state: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let (Some(state), Some(map)) = (discrete_action(state, STATES), map(slf)?) else {
            return slf.call_method1(intern!(py, "_action_mask_in_python"), (state,));
        };
        let DecodedState { row, column, passenger, destination } = DecodedState::new(state);
        let open = |offset: usize| map.as_bytes()[(row + 1) * MAP_SHAPE[1] + 2 * column + offset] == b':';
        let square = (row, column).into_pyobject(py)?;
        let locations = slf.getattr(intern!(py, "locs"))?;
        let pickup = passenger < IN_TAXI && square.eq(locations.get_item(passenger)?)?;
        let dropoff =
            passenger == IN_TAXI && (square.eq(locations.get_item(destination)?)? || locations.contains(square)?);
        let mask = [row < 4, row > 0, column < 4 && open(2), column > 0 && open(0), pickup, dropoff];
        Ok(small_array(py, &mask.map(i8::from)).into_any())
    }
}

/// The characters of the map; None if they are not stored as Gymnasium stores them.
fn map<'py>(taxi: &Bound<'py, PyTaxi>) -> PyResult<Option<Bound<'py, PyBytes>>> {
    let py = taxi.py();
    let map = taxi.getattr(intern!(py, "desc"))?;
    let Ok(characters) = map.cast::<PyUntypedArray>() else { return Ok(None) };
    if characters.shape() != MAP_SHAPE || characters.dtype().kind() != b'S' || characters.dtype().itemsize() != 1 {
        return Ok(None);
    }
    Ok(Some(map.call_method0(intern!(py, "tobytes"))?.cast_into()?))
}
