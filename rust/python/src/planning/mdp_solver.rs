//! `MdpSolver`: the optimal policy of an environment with a transition table.

use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArrayDyn};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use qtab_core::envs::tabular::TabularMdp;
use qtab_core::memory::collect;
use qtab_core::planning::{
    FiniteHorizon, Mdp, PlanningError, PolicyEvaluation, Solution, StationaryPolicy, action_values, expected_visits,
    finite_horizon, policy_evaluation, policy_improvement, policy_iteration, policy_return, stationary_policy, sweep,
    value_iteration,
};
use qtab_core::{Env, StopFlag};

use super::{of_policy, to_py_err};
use crate::convert::{array_from, array_of};
use crate::envs::PyNativeEnv;
use crate::error::allocation;
use crate::interrupt::run_interruptible;

type Array<'py, T> = Bound<'py, PyArray1<T>>;
/// State values, action values, the policy.
type PySolution<'py> = (Array<'py, f64>, Array<'py, f64>, Array<'py, i64>);
/// State values, action values, an error bound.
type PyPolicyValues<'py> = (Array<'py, f64>, Array<'py, f64>, f64);
/// Changes of the policy: the number of remaining steps from which on the action is best, the state, and the action.
type PyPolicyChanges<'py> = (Array<'py, i64>, Array<'py, i64>, Array<'py, i64>);

type Method = fn(&TabularMdp, f64, &StopFlag<'_>) -> Result<Solution, PlanningError>;

/// The Markov decision process of an environment.
#[pyclass(frozen, name = "MdpSolver", module = "qtab._core")]
pub(crate) struct PyMdpSolver(Mdp);

#[pymethods]
impl PyMdpSolver {
    #[new]
    fn new(env: &PyNativeEnv) -> PyResult<Self> {
        let mdp = env.shared().mdp()?;
        mdp.map(Self).ok_or_else(|| PyValueError::new_err("env must have a transition table"))
    }

    /// The row of an agent's table for each state. States that share an observation share a row.
    #[getter]
    fn rows<'py>(&self, py: Python<'py>) -> PyResult<Array<'py, i64>> {
        indices(py, self.0.rows.iter())
    }

    /// The number of actions.
    #[getter]
    fn n_actions(&self) -> usize {
        self.0.table.num_actions()
    }

    /// The probability that an episode starts in each state.
    #[getter]
    fn initial_distribution<'py>(&self, py: Python<'py>) -> PyResult<Array<'py, f64>> {
        array_from(py, self.0.table.initial_distribution())
    }

    /// The outcomes of each state-action pair, the actions of state 0 first, in the order of `P`: probability, next
    /// state, reward, terminated.
    fn transitions(&self) -> Vec<Vec<(f64, u32, f64, bool)>> {
        let pairs = (0..self.0.table.num_states()).flat_map(|state| {
            (0..self.0.table.num_actions()).map(move |action| {
                let outcomes = self.0.table.outcomes(state, action);
                outcomes.map(|(probability, step)| (probability, step.state, step.reward, step.terminated)).collect()
            })
        });
        pairs.collect()
    }

    fn value_iteration<'py>(&self, py: Python<'py>, discount: f64) -> PyResult<PySolution<'py>> {
        self.solve(py, discount, value_iteration)
    }

    fn policy_iteration<'py>(&self, py: Python<'py>, discount: f64) -> PyResult<PySolution<'py>> {
        self.solve(py, discount, policy_iteration)
    }

    /// The solution for `steps` steps, the changes of the policy with the remaining steps, and the expected return.
    fn finite_horizon<'py>(
        &self,
        py: Python<'py>,
        discount: f64,
        steps: u64,
    ) -> PyResult<(PySolution<'py>, PyPolicyChanges<'py>, f64)> {
        let horizon = run_interruptible(py, |stop| finite_horizon(&self.0.table, discount, steps, stop))?;
        let FiniteHorizon { values, q_values, policy, changes, expected_return, .. } =
            horizon.map_err(|error| to_py_err(error, discount))?;
        let changes = (
            array_of(py, changes.iter().map(|change| change.steps_to_go.cast_signed()))?,
            indices(py, changes.iter().map(|change| &change.state))?,
            indices(py, changes.iter().map(|change| &change.action))?,
        );
        Ok((to_python(py, values, q_values, &policy)?, changes, expected_return))
    }

    /// The expected return of a policy within `steps` steps. The policy has an action for each state or for each row,
    /// or an array `(steps, rows)` of them, one row for each number of steps taken.
    fn policy_return(&self, py: Python<'_>, policy: PyReadonlyArrayDyn<'_, i64>, steps: u64) -> PyResult<f64> {
        let actions = policy.as_slice()?;
        let width = policy.as_array().shape().last().copied().unwrap_or(0).max(1);
        if policy.as_array().ndim() > 1 && (actions.len() / width) as u64 != steps {
            return Err(PyValueError::new_err(format!("policy must have actions for each of the {steps} steps")));
        }
        let by_step = actions.chunks(width).map(|actions| self.actions(actions)).collect::<PyResult<Vec<_>>>()?;
        let policy = by_step.concat();
        let expected = run_interruptible(py, |stop| policy_return(&self.0.table, &policy, steps, stop))?;
        expected.map_err(|error| to_py_err(error, 1.0))
    }

    /// The best known policy within `steps` steps that does not depend on the number of steps taken: the action of each
    /// of `rows` rows, its expected return, and whether it is proven optimal; `None` for tables too large to search
    /// within seconds.
    fn stationary_policy<'py>(
        &self,
        py: Python<'py>,
        rows: usize,
        steps: u64,
    ) -> PyResult<Option<(Array<'py, i64>, f64, bool)>> {
        let found = run_interruptible(py, |stop| stationary_policy(&self.0, rows, steps, stop))?;
        let Some(found) = found.map_err(|error| to_py_err(error, 1.0))? else { return Ok(None) };
        let StationaryPolicy { policy, expected_return, proven } = found;
        Ok(Some((indices(py, policy.iter())?, expected_return, proven)))
    }

    /// One step of policy iteration: the values of a policy, which has an action for each row, and an improved action
    /// for each state; `None` if no action is better.
    fn policy_improvement<'py>(
        &self,
        py: Python<'py>,
        policy: PyReadonlyArray1<'py, i64>,
        discount: f64,
    ) -> PyResult<(Array<'py, f64>, Option<Array<'py, i64>>)> {
        let policy = self.actions(policy.as_slice()?)?;
        let found = run_interruptible(py, |stop| policy_improvement(&self.0.table, &policy, discount, stop))?;
        let (values, better) = found.map_err(|error| of_policy(error, discount))?;
        let better = better.map(|better| indices(py, better.iter())).transpose()?;
        Ok((PyArray1::from_vec(py, values), better))
    }

    /// The values of a policy, which has a probability for each row and action, the actions of row 0 first.
    fn policy_evaluation<'py>(
        &self,
        py: Python<'py>,
        policy: PyReadonlyArray1<'py, f64>,
        discount: f64,
    ) -> PyResult<PyPolicyValues<'py>> {
        let policy = self.by_state(policy.as_slice()?)?;
        let found = run_interruptible(py, |stop| {
            let found = policy_evaluation(&self.0.table, &policy, discount, stop)?;
            let q_values = action_values(&self.0.table, discount, &found.values, stop)?;
            Ok((found, q_values))
        })?;
        let (PolicyEvaluation { values, errors }, q_values) = found.map_err(|error| of_policy(error, discount))?;
        let error = errors.into_iter().fold(0.0, f64::max);
        Ok((PyArray1::from_vec(py, values), PyArray1::from_vec(py, q_values), error))
    }

    /// The values after one more sweep: of policy evaluation if a policy is given, otherwise of value iteration.
    fn sweep<'py>(
        &self,
        py: Python<'py>,
        values: PyReadonlyArray1<'py, f64>,
        discount: f64,
        policy: Option<PyReadonlyArray1<'py, f64>>,
        in_place: bool,
    ) -> PyResult<Array<'py, f64>> {
        let mut values = collect(values.as_slice()?.iter().copied()).map_err(allocation)?;
        if values.len() != self.0.table.num_states() {
            return Err(PyValueError::new_err("values must have a number for each state"));
        }
        let policy = policy.map(|policy| self.by_state(policy.as_slice()?)).transpose()?;
        let swept = run_interruptible(py, |stop| {
            sweep(&self.0.table, policy.as_deref(), discount, &mut values, in_place, stop)
        })?;
        swept.map_err(|error| to_py_err(error, discount))?;
        Ok(PyArray1::from_vec(py, values))
    }

    /// The expected number of visits of each state in an episode under a policy with a probability for each row and
    /// action.
    fn expected_visits<'py>(&self, py: Python<'py>, policy: PyReadonlyArray1<'py, f64>) -> PyResult<Array<'py, f64>> {
        let policy = self.by_state(policy.as_slice()?)?;
        let visits = run_interruptible(py, |stop| expected_visits(&self.0.table, &policy, stop))?;
        Ok(PyArray1::from_vec(py, visits.map_err(|error| of_policy(error, 1.0))?))
    }
}

impl PyMdpSolver {
    /// The action of a policy in each state. The policy has an action for each state or for each row.
    fn actions(&self, policy: &[i64]) -> PyResult<Vec<usize>> {
        let by_state = policy.len() == self.0.rows.len();
        let action = |(state, &row): (usize, &usize)| {
            let action =
                policy.get(if by_state { state } else { row }).and_then(|&action| usize::try_from(action).ok());
            action.filter(|&action| action < self.0.table.num_actions())
        };
        let actions: Option<Vec<usize>> = self.0.rows.iter().enumerate().map(action).collect();
        actions.ok_or_else(|| PyValueError::new_err("policy must have an action for each row"))
    }

    /// Converts the probabilities of a policy from rows to states.
    fn by_state(&self, policy: &[f64]) -> PyResult<Vec<f64>> {
        let num_actions = self.0.table.num_actions();
        let rows = self.0.rows.iter().map(|&row| policy.get(row * num_actions..(row + 1) * num_actions));
        let by_state: Option<Vec<&[f64]>> = rows.collect();
        let by_state = by_state.ok_or_else(|| PyValueError::new_err("policy must have probabilities for each row"))?;
        Ok(by_state.concat())
    }

    fn solve<'py>(&self, py: Python<'py>, discount: f64, method: Method) -> PyResult<PySolution<'py>> {
        let solution = run_interruptible(py, |stop| method(&self.0.table, discount, stop))?;
        let Solution { values, q_values, policy, .. } = solution.map_err(|error| to_py_err(error, discount))?;
        to_python(py, values, q_values, &policy)
    }
}

fn to_python<'py>(
    py: Python<'py>,
    values: Vec<f64>,
    q_values: Vec<f64>,
    policy: &[usize],
) -> PyResult<PySolution<'py>> {
    Ok((PyArray1::from_vec(py, values), PyArray1::from_vec(py, q_values), indices(py, policy.iter())?))
}

fn indices<'a, 'py>(py: Python<'py>, indices: impl ExactSizeIterator<Item = &'a usize>) -> PyResult<Array<'py, i64>> {
    array_of(py, indices.map(|&index| (index as u64).cast_signed()))
}
