//! Policies that choose by the observation of a Box: `ObservationPolicySpec` of `qtab/_spec.py`.

use std::sync::Arc;

use numpy::{PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyBool;
use qtab_core::prediction::{Choice, FixedPolicy, ObservationPolicy};
use qtab_core::random::Rng;

use super::box_features::ReadRows;
use super::function_policy::FunctionPolicy;
use crate::convert::{in_c_order, small_array};
use crate::error::{RunError, invalid};
use crate::spec::{DiscretizerSpec, Fields, Variant};

/// A policy, before it reads observations.
#[derive(Clone, Debug)]
pub(crate) enum ObservationPolicySpec {
    /// The same probabilities everywhere, or those of the cell of the task's discretizer.
    Table { probabilities: Arc<[f64]>, is_everywhere: bool },
    /// The action with the largest sum of the active rows' values, over one table or several.
    Greedy { discretizer: DiscretizerSpec, tables: Arc<[f64]>, n_tables: usize },
    /// A function of the observation, in Python.
    Function(Arc<FunctionSpec>),
}

/// A function in Python, and how its answers are read.
#[derive(Debug)]
pub(crate) struct FunctionSpec {
    pub(super) function: Py<PyAny>,
    /// From an answer and its observation to a column or to probabilities.
    pub(super) read: Py<PyAny>,
    /// The number of the first action.
    pub(super) first_action: i64,
}

/// Every kind of policy by its name.
pub(super) const POLICIES: &[Variant<ObservationPolicySpec>] =
    &[("table", table), ("greedy", greedy), ("function", function)];

fn table(fields: &Fields<'_>) -> PyResult<ObservationPolicySpec> {
    let array: PyReadonlyArray2<'_, f64> = fields.get("probabilities")?;
    Ok(ObservationPolicySpec::Table { probabilities: in_c_order(&array)?, is_everywhere: array.shape()[0] == 1 })
}

fn greedy(fields: &Fields<'_>) -> PyResult<ObservationPolicySpec> {
    let array: PyReadonlyArray3<'_, f64> = fields.get("tables")?;
    let tables = in_c_order(&array)?;
    let discretizer = DiscretizerSpec::parse(&fields.nested("discretizer")?)?;
    Ok(ObservationPolicySpec::Greedy { discretizer, tables, n_tables: array.shape()[0] })
}

fn function(fields: &Fields<'_>) -> PyResult<ObservationPolicySpec> {
    let spec = FunctionSpec {
        function: fields.any("function")?.unbind(),
        read: fields.any("read")?.unbind(),
        first_action: fields.get("first_action")?,
    };
    Ok(ObservationPolicySpec::Function(Arc::new(spec)))
}

impl ObservationPolicySpec {
    /// The policy. `rows` makes what finds the rows of a discretizer, of which `own` is the task's; `num_rows` is the number
    /// of that one's rows.
    pub(super) fn build<G>(
        &self,
        num_actions: usize,
        (own, num_rows): (&DiscretizerSpec, usize),
        rows: impl Fn(&DiscretizerSpec) -> PyResult<G>,
    ) -> PyResult<ReadPolicy<G>> {
        match self {
            Self::Table { probabilities, is_everywhere } => {
                let expected = if *is_everywhere { 1 } else { num_rows };
                let possible = |row: &[f64]| row.iter().any(|&probability| probability > 0.0);
                if probabilities.len() != expected * num_actions || !probabilities.chunks(num_actions).all(possible) {
                    let shape = format!("{expected} rows of {num_actions} probabilities");
                    return Err(invalid("probabilities", shape, format!("{} numbers", probabilities.len())));
                }
                let policy = FixedPolicy::new(Arc::clone(probabilities), num_actions);
                let rows = if *is_everywhere { None } else { Some(rows(own)?) };
                Ok(ReadPolicy::Table { rows, policy, row: 0 })
            }
            Self::Greedy { discretizer, tables, n_tables } => {
                let per_table = discretizer.num_rows() * num_actions;
                if discretizer.box_space()? != own.box_space()?
                    || tables.len() != n_tables * per_table
                    || per_table == 0
                {
                    let fit = format!("{per_table} numbers each, for observations like the task's");
                    return Err(invalid("tables", fit, format!("{} numbers", tables.len())));
                }
                let scratch = [vec![0.0; num_actions], vec![0.0; num_actions]];
                Ok(ReadPolicy::Greedy {
                    rows: rows(discretizer)?,
                    tables: Arc::clone(tables),
                    per_table,
                    scratch,
                    action: 0,
                })
            }
            Self::Function(spec) => Ok(ReadPolicy::Function(FunctionPolicy::new(Arc::clone(spec), num_actions))),
        }
    }
}

/// An observation that a policy in Python can read.
pub(crate) trait PyObservation {
    fn to_python<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny>;
}

impl<const M: usize> PyObservation for [f32; M] {
    fn to_python<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        small_array(py, self).into_any()
    }
}

impl PyObservation for Py<PyAny> {
    fn to_python<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        self.bind(py).clone()
    }
}

/// A policy, with what it does at the observation that it read last.
pub(crate) enum ReadPolicy<G> {
    Table {
        /// None where the policy is the same everywhere.
        rows: Option<G>,
        policy: FixedPolicy,
        row: u32,
    },
    Greedy {
        rows: G,
        tables: Arc<[f64]>,
        /// The number of values of a table.
        per_table: usize,
        /// The action values, and those of one table.
        scratch: [Vec<f64>; 2],
        action: usize,
    },
    Function(FunctionPolicy),
}

impl<G> ReadPolicy<G> {
    fn read<O: PyObservation>(&mut self, observation: &O) -> Result<(), RunError>
    where
        G: ReadRows<O>,
    {
        match self {
            Self::Table { rows: None, .. } => Ok(()),
            Self::Table { rows: Some(rows), row, .. } => {
                *row = rows.rows(observation)?.as_ref()[0];
                Ok(())
            }
            Self::Greedy { rows, tables, per_table, scratch: [values, part], action } => {
                let active = rows.rows(observation)?;
                for (index, table) in tables.chunks(*per_table).enumerate() {
                    let sum: &mut [f64] = if index == 0 { values } else { part };
                    add_rows(sum, table, active.as_ref());
                    if index > 0 {
                        values.iter_mut().zip(&*part).for_each(|(value, part)| *value += part);
                    }
                }
                *action = first_of_largest(values);
                Ok(())
            }
            Self::Function(function) => {
                Python::attach(|py| function.read(&observation.to_python(py))).map_err(RunError::from)
            }
        }
    }

    fn sample(&self, rng: &mut impl Rng) -> usize {
        match self {
            Self::Table { policy, row, .. } => policy.choose(*row, rng),
            Self::Greedy { action, .. } => *action,
            Self::Function(function) => function.sample(rng),
        }
    }

    fn probability(&self, action: usize) -> f64 {
        match self {
            Self::Table { policy, row, .. } => policy.probability(*row, action),
            Self::Greedy { action: chosen, .. } => f64::from(u8::from(action == *chosen)),
            Self::Function(function) => function.probability(action),
        }
    }
}

/// The sum of some rows of a table, from left to right.
fn add_rows(sum: &mut [f64], table: &[f64], active: &[u32]) {
    for (index, &row) in active.iter().enumerate() {
        let values = &table[row as usize * sum.len()..][..sum.len()];
        if index == 0 {
            sum.copy_from_slice(values);
        } else {
            sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
        }
    }
}

/// `np.argmax`.
fn first_of_largest(values: &[f64]) -> usize {
    (1..values.len()).fold(0, |best, index| if values[index] > values[best] { index } else { best })
}

/// The policy that acts and, off policy, the one that is evaluated.
pub(crate) struct ObservationPolicies<G> {
    pub(super) behavior: ReadPolicy<G>,
    pub(super) target: Option<ReadPolicy<G>>,
    pub(super) num_actions: usize,
}

/// How many steps of Q-learning on a grid a call of a function in Python counts as.
const CALL_WORK: u64 = 127;

impl<O: PyObservation, G: ReadRows<O>> ObservationPolicy<O> for ObservationPolicies<G> {
    type Error = RunError;

    fn choose(&mut self, observation: &O, rng: &mut impl Rng) -> Result<Choice, RunError> {
        self.behavior.read(observation)?;
        let action = self.behavior.sample(rng);
        let Some(target) = &mut self.target else { return Ok(Choice { action: action as u32, ratio: 1.0 }) };
        target.read(observation)?;
        for other in 0..self.num_actions {
            let probability = target.probability(other);
            if probability > 0.0 && self.behavior.probability(other) == 0.0 {
                return Err(Python::attach(|py| not_covered(&observation.to_python(py), other, probability)).into());
            }
        }
        let ratio = target.probability(action) / self.behavior.probability(action);
        Ok(Choice { action: action as u32, ratio })
    }

    fn work(&self) -> u64 {
        let is_function = |source: &ReadPolicy<G>| matches!(source, ReadPolicy::Function(_));
        let calls = u64::from(is_function(&self.behavior)) + u64::from(self.target.as_ref().is_some_and(is_function));
        calls * CALL_WORK
    }
}

fn not_covered(observation: &Bound<'_, PyAny>, action: usize, probability: f64) -> PyErr {
    let shown = observation.call_method0("tolist").and_then(|list| list.repr()).map(|text| text.to_string());
    pyo3::exceptions::PyValueError::new_err(format!(
        "behavior must cover policy: it never takes action {action} at the observation {}, which policy takes with \
         probability {probability}",
        shown.unwrap_or_default()
    ))
}

/// The number of an answer, if it is a plain integer.
pub(super) fn integer(answer: &Bound<'_, PyAny>) -> Option<i64> {
    if answer.is_instance_of::<PyBool>() { None } else { answer.extract().ok() }
}
