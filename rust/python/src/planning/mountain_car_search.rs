//! `MountainCarSearch`: the best known ways out of `MountainCar`'s valley.

use numpy::PyArray1;
use pyo3::prelude::*;
use qtab_core::envs::Parameters;
use qtab_core::envs::classic_control::{MountainCar, MountainCarState};
use qtab_core::planning::{self, BEAM, CostToGo, STARTS};

use super::to_py_err;
use crate::error::invalid;
use crate::interrupt::run_interruptible;

type Array<'py, T> = Bound<'py, PyArray1<T>>;
/// Initial positions, and the actions from each to the goal.
type Routes<'py> = (Array<'py, f64>, Vec<Option<Array<'py, u8>>>);

/// The cost-to-go of a car's states, computed on a grid.
#[pyclass(frozen, name = "MountainCarSearch", module = "qtab._core")]
pub(crate) struct PyMountainCarSearch {
    cost_to_go: CostToGo,
    max_steps: u64,
}

#[pymethods]
impl PyMountainCarSearch {
    /// `parameters` are pairs of a name and a value; an episode has at most `max_steps` steps.
    #[new]
    fn new(py: Python<'_>, parameters: Vec<(String, f64)>, max_steps: u64) -> PyResult<Self> {
        let mut car = MountainCar::default();
        for (name, value) in parameters {
            let parameter = car.parameter(&name);
            *parameter.ok_or_else(|| invalid("parameters", "MountainCar's", format!("'{name}'")))? = value;
        }
        let cost_to_go = run_interruptible(py, |stop| CostToGo::new(car, max_steps, stop))?;
        Ok(Self { cost_to_go: cost_to_go.map_err(|error| to_py_err(error, 1.0))?, max_steps })
    }

    /// The positions and the velocities of the grid.
    fn axes<'py>(&self, py: Python<'py>) -> [Array<'py, f64>; 2] {
        self.cost_to_go.axes().map(|axis| PyArray1::from_vec(py, axis))
    }

    /// The steps to the goal from every point of the grid, and after each action.
    fn steps<'py>(&self, py: Python<'py>) -> (Array<'py, f64>, Array<'py, f64>) {
        (PyArray1::from_slice(py, self.cost_to_go.grid()), PyArray1::from_vec(py, self.cost_to_go.action_grid()))
    }

    /// The best action of an observation.
    fn action(&self, position: f64, velocity: f64) -> usize {
        self.cost_to_go.best_action(MountainCarState { position, velocity })
    }

    /// The initial positions, and from each the actions that lead to the goal; None where the search found none.
    fn routes<'py>(&self, py: Python<'py>) -> PyResult<Routes<'py>> {
        let starts = planning::starts(STARTS);
        let routes = run_interruptible(py, |stop| {
            let search = |&start: &f64| planning::beam_search(&self.cost_to_go, start, self.max_steps, BEAM, stop);
            starts.iter().map(search).collect::<Result<Vec<_>, _>>()
        })?;
        let routes = routes.map_err(|error| to_py_err(error, 1.0))?;
        let routes = routes.into_iter().map(|route| route.map(|actions| PyArray1::from_vec(py, actions)));
        Ok((PyArray1::from_slice(py, &starts), routes.collect()))
    }

    /// The steps from each initial position by the greedy policy of the cost-to-go.
    fn rollout_lengths<'py>(&self, py: Python<'py>) -> PyResult<Array<'py, i64>> {
        let lengths = run_interruptible(py, |stop| {
            let rollout = |&start: &f64| {
                planning::greedy_rollout(&self.cost_to_go, start, self.max_steps, stop).map(u64::cast_signed)
            };
            planning::starts(STARTS).iter().map(rollout).collect::<Result<Vec<_>, _>>()
        })?;
        Ok(PyArray1::from_vec(py, lengths.map_err(|error| to_py_err(error, 1.0))?))
    }
}
