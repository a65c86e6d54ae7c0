//! Conversion and validation of Gymnasium's `P` as a table in Rust.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use qtab_core::Env;
use qtab_core::envs::tabular::{InvalidMdp, Outcome, TabularMdp};
use qtab_core::envs::toy_text::{LakeRewards, TaxiMap, cliff_walking, frozen_lake, taxi_table};
use qtab_core::memory::reserve;

use crate::convert::double;
use crate::error::allocation;

/// The number of states of a table that are read between two checks for signals.
const STATES_BETWEEN_CHECKS: usize = 1024;

/// The table of an environment. It is an error if `NumPy` would add its probabilities differently from Python floats.
pub(in crate::envs) fn table_of(env: &Bound<'_, PyAny>) -> PyResult<TabularMdp> {
    let py = env.py();
    let table = env.getattr(intern!(py, "P"))?;
    if let Ok(known) = table.cast::<PyTransitionTable>() {
        return Ok(known.get().0.clone());
    }
    let initial: Vec<f64> = env.getattr(intern!(py, "initial_state_distrib"))?.extract()?;
    parse_table(&table, &initial, true)
}

/// `P[state][action]` lists (probability, state, reward, terminated); `initial` is `initial_state_distrib`. With
/// `floats_only`, probabilities must be Python floats.
fn parse_table(table: &Bound<'_, PyAny>, initial: &[f64], floats_only: bool) -> PyResult<TabularMdp> {
    let wrong_type = |_| PyTypeError::new_err("P must hold for each state and action a list of outcomes");
    let states = table.len().map_err(wrong_type)?;
    if states != initial.len() {
        return Err(PyValueError::new_err(format!(
            "initial_state_distrib must hold {states} numbers, one for each state, got {}",
            initial.len()
        )));
    }
    let mut rows = Vec::new();
    let mut actions = 0;
    for state in 0..states {
        let missing =
            |_| PyValueError::new_err(format!("P must have the states 0 to {}, it lacks {state}", states - 1));
        if state % STATES_BETWEEN_CHECKS == 0 {
            table.py().check_signals()?;
        }
        let row = table.get_item(state).map_err(missing)?;
        let count = row.len().map_err(wrong_type)?;
        if state == 0 {
            actions = count;
        }
        if count != actions {
            return Err(PyValueError::new_err(format!(
                "P[{state}] must have {actions} actions as P[0] has, got {count}"
            )));
        }
        for action in 0..actions {
            let missing = |_| {
                PyValueError::new_err(format!(
                    "P[{state}] must have the actions 0 to {}, it lacks {action}",
                    actions - 1
                ))
            };
            let path = || format!("P[{state}][{action}]");
            reserve(&mut rows, 1).map_err(allocation)?;
            rows.push(parse_outcomes(path, &row.get_item(action).map_err(missing)?, floats_only)?);
        }
    }
    TabularMdp::new(actions, initial, &rows).map_err(|error| PyValueError::new_err(error.to_string()))
}

/// The outcomes of a state and an action; `path` names their place in `P`.
fn parse_outcomes(path: impl Fn() -> String, outcomes: &Bound<'_, PyAny>, floats_only: bool) -> PyResult<Vec<Outcome>> {
    // An iterator without a length could be read only once, and Python reads the table as well.
    let entries = outcomes.len().and_then(|_| outcomes.try_iter());
    let entries = entries.map_err(|_| PyTypeError::new_err(format!("{} must be a list of outcomes", path())))?;
    entries.enumerate().map(|(index, entry)| parse_outcome(&path, index, &entry?, floats_only)).collect()
}

fn parse_outcome(
    path: &impl Fn() -> String,
    index: usize,
    entry: &Bound<'_, PyAny>,
    floats_only: bool,
) -> PyResult<Outcome> {
    if floats_only && entry.get_item(0).is_ok_and(|probability| double(&probability).is_none()) {
        return Err(PyTypeError::new_err(format!("{}[{index}] must have a float for a probability", path())));
    }
    match entry.extract() {
        Ok((probability, state, reward, terminated)) => Ok(Outcome { probability, state, reward, terminated }),
        Err(_) => Err(PyTypeError::new_err(format!(
            "{}[{index}] must be (probability, state, reward, terminated), got {}",
            path(),
            entry.repr()?
        ))),
    }
}

/// A validated transition table.
#[pyclass(frozen, eq, name = "TransitionTable", module = "qtab._core")]
#[derive(PartialEq)]
pub(crate) struct PyTransitionTable(TabularMdp);

#[pymethods]
impl PyTransitionTable {
    /// `P[state][action]` lists (probability, state, reward, terminated).
    #[new]
    #[expect(non_snake_case, reason = "Gymnasium's name")]
    fn new(P: &Bound<'_, PyAny>, initial_state_distrib: Vec<f64>) -> PyResult<Self> {
        parse_table(P, &initial_state_distrib, false).map(Self)
    }

    /// The table of Gymnasium's `CliffWalkingEnv`.
    #[staticmethod]
    fn cliff_walking(is_slippery: bool) -> PyResult<Self> {
        known(cliff_walking(is_slippery))
    }

    /// The table of Gymnasium's `FrozenLakeEnv` with a map of these lines, all of the same length, and rewards for
    /// reaching the goal, a hole and frozen ground. Without a success rate, the ice is not slippery.
    #[staticmethod]
    #[pyo3(signature = (lines, success_rate, rewards))]
    fn frozen_lake(lines: Vec<Vec<u8>>, success_rate: Option<f64>, rewards: [f64; 3]) -> PyResult<Self> {
        let [goal, hole, frozen] = rewards;
        known(frozen_lake(&lines, success_rate, LakeRewards { goal, hole, frozen }))
    }

    /// The table of Gymnasium's `TaxiEnv` with a map of 7 lines of 11 characters. Without a probability, the weather is
    /// dry.
    #[staticmethod]
    #[pyo3(signature = (lines, rainy_probability))]
    fn taxi(lines: TaxiMap, rainy_probability: Option<f64>) -> PyResult<Self> {
        known(taxi_table(&lines, rainy_probability))
    }

    #[getter]
    fn states(&self) -> usize {
        self.0.num_states()
    }

    #[getter]
    fn actions(&self) -> usize {
        self.0.num_actions()
    }
}

fn known(table: Result<TabularMdp, InvalidMdp>) -> PyResult<PyTransitionTable> {
    table.map(PyTransitionTable).map_err(|error| PyValueError::new_err(error.to_string()))
}
