//! `GridSearch`: the best known policies of classic control.

use numpy::{PyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use qtab_core::envs::Parameters;
use qtab_core::envs::classic_control::{Acrobot, CartPole, MountainCar, Pendulum};
use qtab_core::memory::collect;
use qtab_core::planning::grid::{GridTask, GridValues, Rollout, beam_search, grid_torque, replay, rollouts};

use super::to_py_err;
use crate::convert::{array_from, array_of};
use crate::error::{allocation, invalid};
use crate::interrupt::run_interruptible;

type Array<'py, T> = Bound<'py, PyArray1<T>>;
/// The returns of episodes, and their lengths.
type Episodes<'py> = (Array<'py, f64>, Array<'py, i64>);
/// The actions from each state; None if no route was found.
type Routes<'py> = Vec<Option<Array<'py, u8>>>;

/// The constants of an environment: its numbers, and its flags.
type Constants = (Vec<(String, f64)>, Vec<(String, bool)>);

/// State values on a grid.
enum AnyGrid {
    MountainCar(GridValues<MountainCar, 2>),
    Pendulum(GridValues<Pendulum, 2>),
    CartPole(GridValues<CartPole, 4>),
    Acrobot(GridValues<Acrobot, 4>),
}

/// Evaluates an expression for grid values of any type.
macro_rules! on_grid {
    ($grid:expr, $values:ident => $result:expr) => {
        match $grid {
            AnyGrid::MountainCar($values) => $result,
            AnyGrid::Pendulum($values) => $result,
            AnyGrid::CartPole($values) => $result,
            AnyGrid::Acrobot($values) => $result,
        }
    };
}

/// The values of an environment's states, computed on a grid, and the policy that is greedy for them.
#[pyclass(frozen, name = "GridSearch", module = "qtab._core")]
pub(crate) struct PyGridSearch {
    grid: AnyGrid,
    max_steps: u64,
}

#[pymethods]
impl PyGridSearch {
    /// `parameters` holds pairs of a name and a value, `flags` pairs of a name and a bool. An episode has at most
    /// `max_steps` steps.
    #[new]
    fn new(
        py: Python<'_>,
        name: &str,
        parameters: Vec<(String, f64)>,
        flags: Vec<(String, bool)>,
        max_steps: u64,
    ) -> PyResult<Self> {
        let given = (parameters, flags);
        let grid = match name {
            "MountainCar" => AnyGrid::MountainCar(values(py, with(MountainCar::default(), given)?, max_steps)?),
            "Pendulum" => AnyGrid::Pendulum(values(py, with(Pendulum::default(), given)?, max_steps)?),
            "CartPole" => AnyGrid::CartPole(values(py, with(CartPole::default(), given)?, max_steps)?),
            "Acrobot" => AnyGrid::Acrobot(values(py, with(Acrobot::default(), given)?, max_steps)?),
            _ => return Err(invalid("name", "MountainCar, Pendulum, CartPole or Acrobot", format!("'{name}'"))),
        };
        Ok(Self { grid, max_steps })
    }

    /// The coordinates of the grid points along each axis.
    fn axes<'py>(&self, py: Python<'py>) -> Vec<Array<'py, f64>> {
        on_grid!(&self.grid, values => values.axes().map(|axis| PyArray1::from_vec(py, axis)).into())
    }

    /// The state values at every point of the grid, and the action values there, both in C order.
    fn values<'py>(&self, py: Python<'py>) -> PyResult<(Array<'py, f64>, Array<'py, f64>)> {
        on_grid!(&self.grid, values => Ok((array_from(py, values.grid())?, array_from(py, values.action_grid())?)))
    }

    /// The torque of each action of a pendulum; empty for the other environments.
    fn torques<'py>(&self, py: Python<'py>) -> Array<'py, f32> {
        let torques = match &self.grid {
            AnyGrid::Pendulum(values) => {
                let actions = 0..<Pendulum as GridTask<2>>::ACTIONS;
                actions.map(|action| grid_torque(values.task(), action)).collect()
            }
            _ => Vec::new(),
        };
        PyArray1::from_vec(py, torques)
    }

    /// The best action in a state.
    fn action(&self, state: Vec<f64>) -> PyResult<usize> {
        on_grid!(&self.grid, values => Ok(values.best_action(components(&state)?)))
    }

    /// The returns and lengths of episodes from the (starts, components) states under the greedy policy, which sees
    /// float32 observations.
    fn rollouts<'py>(&self, py: Python<'py>, starts: PyReadonlyArray2<'py, f64>) -> PyResult<Episodes<'py>> {
        on_grid!(&self.grid, values => {
            let starts = states(&starts)?;
            let found = run_interruptible(py, |stop| rollouts(values, &starts, self.max_steps, stop))?;
            episodes(py, &found.map_err(|error| to_py_err(error, 1.0))?)
        })
    }

    /// The actions that lead from each of the (starts, components) states to the end of an episode, found by a search
    /// that keeps `beam` states after each step, with the returns and lengths of those episodes. If the search finds no
    /// route, there are no actions, and the episode is that of the greedy policy.
    fn routes<'py>(
        &self,
        py: Python<'py>,
        starts: PyReadonlyArray2<'py, f64>,
        beam: usize,
    ) -> PyResult<(Routes<'py>, Episodes<'py>)> {
        on_grid!(&self.grid, values => {
            let starts = states(&starts)?;
            let found = run_interruptible(py, |stop| {
                let search = |&start| {
                    let Some(actions) = beam_search(values, start, self.max_steps, beam, stop)? else {
                        return Ok((None, rollouts(values, &[start], self.max_steps, stop)?[0]));
                    };
                    let rollout = replay(values.task(), start, &actions);
                    Ok((Some(actions), rollout))
                };
                starts.iter().map(search).collect::<Result<Vec<_>, _>>()
            })?;
            let (routes, found): (Vec<_>, Vec<_>) = found.map_err(|error| to_py_err(error, 1.0))?.into_iter().unzip();
            let routes = routes.into_iter().map(|route| route.map(|actions| PyArray1::from_vec(py, actions)));
            Ok((routes.collect(), episodes(py, &found)?))
        })
    }
}

fn episodes<'py>(py: Python<'py>, rollouts: &[Rollout]) -> PyResult<Episodes<'py>> {
    let returns = array_of(py, rollouts.iter().map(|rollout| rollout.total))?;
    Ok((returns, array_of(py, rollouts.iter().map(|rollout| rollout.steps.cast_signed()))?))
}

/// An environment with the given constants.
fn with<E: Parameters>(mut env: E, (parameters, flags): Constants) -> PyResult<E> {
    for (name, value) in parameters {
        let parameter = env.parameter(&name);
        *parameter.ok_or_else(|| invalid("parameters", "the environment's", format!("'{name}'")))? = value;
    }
    for (name, value) in flags {
        *env.flag(&name).ok_or_else(|| invalid("flags", "the environment's", format!("'{name}'")))? = value;
    }
    Ok(env)
}

fn values<T, const D: usize>(py: Python<'_>, task: T, max_steps: u64) -> PyResult<GridValues<T, D>>
where
    T: GridTask<D> + Send + Sync,
{
    let values = run_interruptible(py, |stop| GridValues::new(task, max_steps, 1, stop))?;
    values.map_err(|error| to_py_err(error, 1.0))
}

/// The states in the rows of an array.
fn states<const D: usize>(rows: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<[f64; D]>> {
    if rows.shape()[1] != D {
        return Err(invalid("starts", format!("states of {D} numbers"), rows.shape()[1]));
    }
    let rows = rows.as_array();
    collect(rows.rows().into_iter().map(|row| std::array::from_fn(|axis| row[axis]))).map_err(allocation)
}

/// The numbers of a state.
fn components<const D: usize>(state: &[f64]) -> PyResult<[f64; D]> {
    state.try_into().map_err(|_| invalid("state", format!("{D} numbers"), state.len()))
}
