//! The truth: dynamic programming over what has a table, and the search over the car's dynamics.

use std::sync::atomic::AtomicBool;

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::{PyKeyboardInterrupt, PyValueError};
use pyo3::prelude::*;
use qtab_core::Env;
use qtab_core::envs::Parameters;
use qtab_core::envs::classic_control::{MountainCar, MountainCarState};
use qtab_core::envs::toy_text::{Blackjack, Taxi};
use qtab_core::planning;
use qtab_core::planning::{
    BEAM, CostToGo, FiniteHorizon, Mdp, PlanningError, STARTS, Solution, finite_horizon, policy_iteration,
    policy_return, value_iteration,
};

use crate::door;
use crate::finite;

type Array<'py, T> = Bound<'py, PyArray1<T>>;
/// Values, values of the actions, the policy.
type Solved<'py> = (Array<'py, f64>, Array<'py, f64>, Array<'py, i64>);
/// Starts, and the actions from each to the goal.
type Routes<'py> = (Array<'py, f64>, Vec<Option<Array<'py, u8>>>);
/// From how many steps left on, where, which action is best.
type Changes<'py> = (Array<'py, i64>, Array<'py, i64>, Array<'py, i64>);

/// A table to plan on.
#[pyclass(frozen, module = "qtab._core")]
pub(crate) struct Planner(Mdp);

#[derive(FromPyObject)]
enum Described {
    Process(finite::Process),
    Rules(finite::Rules),
}

#[pymethods]
impl Planner {
    #[new]
    fn new(py: Python<'_>, process: Described) -> PyResult<Self> {
        let process = match process {
            Described::Process(finite::Process { table, fickle }) => {
                Mdp::try_from(&Taxi { table: table.bind(py).get().0.clone(), fickle })
            }
            Described::Rules(finite::Rules { natural, sab }) => Mdp::try_from(&Blackjack { natural, sab }),
        };
        process.map(Self).map_err(|bad| PyValueError::new_err(bad.to_string()))
    }

    /// For each state the row of an agent's table that it lights.
    #[getter]
    fn rows<'py>(&self, py: Python<'py>) -> Array<'py, i64> {
        numbers(py, &self.0.rows)
    }

    fn value_iteration<'py>(&self, py: Python<'py>, discount: f64) -> PyResult<Solved<'py>> {
        self.solve(py, discount, value_iteration)
    }

    fn policy_iteration<'py>(&self, py: Python<'py>, discount: f64) -> PyResult<Solved<'py>> {
        self.solve(py, discount, policy_iteration)
    }

    /// What is solved, how the policy depends on the steps left, and the expected return.
    fn finite_horizon<'py>(
        &self,
        py: Python<'py>,
        discount: f64,
        steps: u64,
    ) -> PyResult<(Solved<'py>, Changes<'py>, f64)> {
        let horizon = door::detached(py, |stop| finite_horizon(&self.0.table, discount, steps, stop))?;
        let FiniteHorizon { values, q_values, policy, changes, expected_return, .. } =
            horizon.map_err(|unsolved| refused(unsolved, discount))?;
        let changes = (
            PyArray1::from_iter(py, changes.iter().map(|change| change.steps_to_go.cast_signed())),
            numbers(py, changes.iter().map(|change| &change.state)),
            numbers(py, changes.iter().map(|change| &change.action)),
        );
        Ok((solved(py, values, q_values, &policy), changes, expected_return))
    }

    /// What a policy returns on average within so many steps: an action for each state, or for each row.
    fn policy_return(&self, py: Python<'_>, policy: PyReadonlyArray1<'_, i64>, steps: u64) -> PyResult<f64> {
        let policy = policy.as_slice()?;
        let by_state = policy.len() == self.0.rows.len();
        let action = |(state, &row): (usize, &usize)| {
            let action =
                policy.get(if by_state { state } else { row }).and_then(|&action| usize::try_from(action).ok());
            action.filter(|&action| action < self.0.table.num_actions())
        };
        let policy: Option<Vec<usize>> = self.0.rows.iter().enumerate().map(action).collect();
        let policy = policy.ok_or_else(|| PyValueError::new_err("policy must have an action for each row"))?;
        let expected = door::detached(py, |stop| policy_return(&self.0.table, &policy, steps, stop))?;
        expected.map_err(|unsolved| refused(unsolved, 1.0))
    }
}

impl Planner {
    fn solve<'py>(
        &self,
        py: Python<'py>,
        discount: f64,
        method: fn(&qtab_core::envs::tabular::TabularMdp, f64, &AtomicBool) -> Result<Solution, PlanningError>,
    ) -> PyResult<Solved<'py>> {
        let solution = door::detached(py, |stop| method(&self.0.table, discount, stop))?;
        let Solution { values, q_values, policy, .. } = solution.map_err(|unsolved| refused(unsolved, discount))?;
        Ok(solved(py, values, q_values, &policy))
    }
}

/// The car's valley, its cost-to-go computed.
#[pyclass(frozen, module = "qtab._core")]
pub(crate) struct Valley {
    guide: CostToGo,
    limit: u64,
}

#[pymethods]
impl Valley {
    #[new]
    fn new(py: Python<'_>, parameters: Vec<(String, f64)>, limit: u64) -> PyResult<Self> {
        let mut car = MountainCar::default();
        for (name, value) in parameters {
            let parameter = car.parameter(&name);
            *parameter.ok_or_else(|| PyValueError::new_err(format!("MountainCar has no constant {name:?}")))? = value;
        }
        let guide = door::detached(py, |stop| CostToGo::new(car, limit, stop))?;
        Ok(Self { guide: guide.map_err(|unsolved| refused(unsolved, 1.0))?, limit })
    }

    /// The positions and the velocities of the grid.
    fn axes<'py>(&self, py: Python<'py>) -> [Array<'py, f64>; 2] {
        self.guide.axes().map(|axis| PyArray1::from_vec(py, axis))
    }

    /// The steps of all points, and of each action.
    fn steps<'py>(&self, py: Python<'py>) -> (Array<'py, f64>, Array<'py, f64>) {
        (PyArray1::from_slice(py, self.guide.grid()), PyArray1::from_vec(py, self.guide.action_grid()))
    }

    /// The best action of an observation.
    fn action(&self, position: f64, velocity: f64) -> usize {
        self.guide.best_action(MountainCarState { position, velocity })
    }

    /// The starting positions, and from each the actions that lead to the goal; None where no way was found.
    fn routes<'py>(&self, py: Python<'py>) -> PyResult<Routes<'py>> {
        let starts = planning::starts(STARTS);
        let routes = door::detached(py, |stop| {
            let route = |&position: &f64| planning::beam_search(&self.guide, position, self.limit, BEAM, stop);
            starts.iter().map(route).collect::<Result<Vec<_>, _>>()
        })?;
        let routes = routes.map_err(|unsolved| refused(unsolved, 1.0))?;
        let routes = routes.into_iter().map(|route| route.map(|actions| PyArray1::from_vec(py, actions)));
        Ok((PyArray1::from_slice(py, &starts), routes.collect()))
    }

    /// The steps from each of the starting positions by the best actions of the observations.
    fn followed<'py>(&self, py: Python<'py>) -> PyResult<Array<'py, i64>> {
        let lengths = door::detached(py, |stop| {
            let starts = planning::starts(STARTS);
            let follow =
                |&start: &f64| planning::greedy_rollout(&self.guide, start, self.limit, stop).map(u64::cast_signed);
            starts.iter().map(follow).collect::<Result<Vec<_>, _>>()
        })?;
        Ok(PyArray1::from_vec(py, lengths.map_err(|unsolved| refused(unsolved, 1.0))?))
    }
}

fn solved<'py>(py: Python<'py>, values: Vec<f64>, q_values: Vec<f64>, policy: &[usize]) -> Solved<'py> {
    (PyArray1::from_vec(py, values), PyArray1::from_vec(py, q_values), numbers(py, policy))
}

fn numbers<'a, 'py>(py: Python<'py>, numbers: impl IntoIterator<Item = &'a usize>) -> Array<'py, i64> {
    PyArray1::from_vec(py, numbers.into_iter().map(|&number| (number as u64).cast_signed()).collect())
}

fn refused(unsolved: PlanningError, discount: f64) -> PyErr {
    if unsolved == PlanningError::Stopped {
        return PyKeyboardInterrupt::new_err(());
    }
    PyValueError::new_err(format!(
        "discount must be smaller here, got {discount}: {unsolved}; method 'finite_horizon' fits any discount"
    ))
}
