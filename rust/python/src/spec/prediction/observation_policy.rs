//! Policies that choose by the observation of a Box: `ObservationPolicySpec` of `qtab/_spec.py`.

use std::sync::Arc;

use numpy::{PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyBool;
use qtab_core::prediction::ObservationPolicy;
use qtab_core::random::Rng;

use super::box_features::ReadRows;
use super::py_observation::PyObservation;
use crate::convert::in_c_order;
use crate::error::{RunError, invalid};
use crate::spec::{DiscretizerSpec, Fields, Variant};

/// The description of a policy, before it reads observations.
#[derive(Clone, Debug)]
pub(crate) enum ObservationPolicySpec {
    /// The same probabilities everywhere, or separate ones for each cell of the task's discretizer.
    Table { probabilities: Arc<[f64]>, is_everywhere: bool },
    /// The action with the largest sum of the active rows' values, over one or several tables.
    Greedy { discretizer: DiscretizerSpec, tables: Arc<[f64]>, n_tables: usize },
    /// A function of the observation, in Python.
    Function(Arc<FunctionSpec>),
}

/// A Python function, and the reader of its return values.
#[derive(Debug)]
pub(crate) struct FunctionSpec {
    function: Py<PyAny>,
    /// Converts a return value and its observation to probabilities.
    read: Py<PyAny>,
    /// The number of the first action.
    first_action: i64,
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
    /// Whether the policy is a Python function, which is called at each step.
    pub(super) fn calls_python(&self) -> bool {
        matches!(self, Self::Function(_))
    }

    /// The policy, where `own` is the task's discretizer. `rows` makes the row finder of a discretizer.
    pub(super) fn build<G>(
        &self,
        num_actions: usize,
        own: &DiscretizerSpec,
        rows: impl Fn(&DiscretizerSpec) -> PyResult<G>,
    ) -> PyResult<ReadPolicy<G>> {
        let reader = match self {
            Self::Table { probabilities, is_everywhere } => {
                let expected = if *is_everywhere { 1 } else { own.num_rows() };
                check_probabilities("probabilities", probabilities, num_actions, Some(expected))?;
                let possible = |row: &[f64]| row.iter().filter(|&&probability| probability > 0.0).count();
                let is_deterministic = probabilities.chunks(num_actions).all(|row| possible(row) == 1);
                PolicyReader::Table {
                    probabilities: Arc::clone(probabilities),
                    is_everywhere: *is_everywhere,
                    is_deterministic,
                }
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
                PolicyReader::Greedy { rows: rows(discretizer)?, tables: Arc::clone(tables), per_table, scratch }
            }
            Self::Function(spec) => PolicyReader::Function(Arc::clone(spec)),
        };
        Ok(ReadPolicy { reader, action: None, probabilities: vec![0.0; num_actions] })
    }
}

/// Checks that there are probabilities for `num_actions` actions in each state, and that every state has an action.
pub(super) fn check_probabilities(
    name: &str,
    probabilities: &[f64],
    num_actions: usize,
    states: Option<usize>,
) -> PyResult<()> {
    let possible = |row: &[f64]| row.iter().any(|&probability| probability > 0.0);
    if num_actions > 0
        && probabilities.len().is_multiple_of(num_actions)
        && states.is_none_or(|states| probabilities.len() == states * num_actions)
        && probabilities.chunks(num_actions).all(possible)
    {
        return Ok(());
    }
    let states = states.map_or("the".to_owned(), |states| states.to_string());
    let expected = format!("{num_actions} probabilities for each of {states} states");
    Err(invalid(name, expected, format!("{} numbers", probabilities.len())))
}

/// A policy, with its choice for the observation that it read last.
pub(crate) struct ReadPolicy<G> {
    reader: PolicyReader<G>,
    /// The action; `None` if the policy has probabilities.
    action: Option<usize>,
    /// The probabilities of the actions.
    probabilities: Vec<f64>,
}

/// The reader of a policy's observations.
enum PolicyReader<G> {
    Table {
        probabilities: Arc<[f64]>,
        is_everywhere: bool,
        is_deterministic: bool,
    },
    Greedy {
        rows: G,
        tables: Arc<[f64]>,
        /// The number of values of a table.
        per_table: usize,
        /// The action values, and the action values of one table.
        scratch: [Vec<f64>; 2],
    },
    Function(Arc<FunctionSpec>),
}

impl<G> ReadPolicy<G> {
    /// `own` is the row of the observation in the task's discretizer.
    fn read<O: PyObservation>(&mut self, observation: &O, own: u32) -> Result<(), RunError>
    where
        G: ReadRows<O>,
    {
        match &mut self.reader {
            PolicyReader::Table { probabilities, is_everywhere, is_deterministic } => {
                let (row, count) = (if *is_everywhere { 0 } else { own as usize }, self.probabilities.len());
                self.probabilities.copy_from_slice(&probabilities[row * count..][..count]);
                let possible = self.probabilities.iter().position(|&probability| probability > 0.0);
                self.action = possible.filter(|_| *is_deterministic);
            }
            PolicyReader::Greedy { rows, tables, per_table, scratch: [values, part] } => {
                let active = rows.rows(observation)?;
                for (index, table) in tables.chunks(*per_table).enumerate() {
                    let sum: &mut [f64] = if index == 0 { values } else { part };
                    add_rows(sum, table, active.as_ref());
                    if index > 0 {
                        values.iter_mut().zip(&*part).for_each(|(value, part)| *value += part);
                    }
                }
                self.action = Some(first_of_largest(values));
            }
            PolicyReader::Function(spec) => {
                self.action = Python::attach(|py| spec.call(&observation.to_python(py)?, &mut self.probabilities))?;
            }
        }
        Ok(())
    }

    /// The action if there is one, otherwise the first action whose cumulative probability exceeds one `random()`.
    fn sample(&self, rng: &mut impl Rng) -> usize {
        if let Some(action) = self.action {
            return action;
        }
        let (random, mut sum, mut last) = (rng.random(), 0.0, 0);
        for (action, &probability) in self.probabilities.iter().enumerate() {
            if probability > 0.0 {
                sum += probability;
                last = action;
                if random < sum {
                    break;
                }
            }
        }
        last
    }

    fn probability(&self, action: usize) -> f64 {
        self.action.map_or(self.probabilities[action], |chosen| f64::from(u8::from(action == chosen)))
    }
}

impl FunctionSpec {
    /// Calls the function. Returns its action, or writes its probabilities and returns `None`.
    fn call(&self, observation: &Bound<'_, PyAny>, probabilities: &mut [f64]) -> PyResult<Option<usize>> {
        let py = observation.py();
        let answer = self.function.bind(py).call1((observation,))?;
        let number: Option<i64> = if answer.is_instance_of::<PyBool>() { None } else { answer.extract().ok() };
        let column = number.and_then(|number| usize::try_from(number.checked_sub(self.first_action)?).ok());
        if let Some(column) = column.filter(|&column| column < probabilities.len()) {
            return Ok(Some(column));
        }
        // Python reads, or rejects, anything that is not a valid number.
        let read: Vec<f64> = self.read.bind(py).call1((answer, observation))?.extract()?;
        probabilities.copy_from_slice(&read);
        Ok(None)
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

/// The policy that acts and, off policy, the policy that is evaluated.
pub(crate) struct ObservationPolicies<G> {
    pub(super) behavior: ReadPolicy<G>,
    pub(super) target: Option<ReadPolicy<G>>,
    pub(super) num_actions: usize,
}

/// The number of Q-learning steps on a grid that a call of a Python function counts as.
const CALL_WORK: u64 = 127;

impl<O: PyObservation, G: ReadRows<O>> ObservationPolicy<O> for ObservationPolicies<G> {
    type Error = RunError;

    fn choose(&mut self, observation: &O, active: &[u32], rng: &mut impl Rng) -> Result<(usize, f64), RunError> {
        self.behavior.read(observation, active[0])?;
        let action = self.behavior.sample(rng);
        let Some(target) = &mut self.target else { return Ok((action, 1.0)) };
        target.read(observation, active[0])?;
        for other in 0..self.num_actions {
            let probability = target.probability(other);
            if probability > 0.0 && self.behavior.probability(other) == 0.0 {
                return Err(Python::attach(|py| not_covered(observation.to_python(py), other, probability)).into());
            }
        }
        Ok((action, target.probability(action) / self.behavior.probability(action)))
    }

    fn work(&self) -> u64 {
        let policies = self.target.iter().chain([&self.behavior]);
        CALL_WORK * policies.filter(|policy| matches!(policy.reader, PolicyReader::Function(_))).count() as u64
    }
}

fn not_covered(observation: PyResult<Bound<'_, PyAny>>, action: usize, probability: f64) -> PyErr {
    let list = observation.and_then(|observation| observation.call_method0("tolist"));
    let shown = list.and_then(|list| list.repr()).map(|text| text.to_string());
    pyo3::exceptions::PyValueError::new_err(format!(
        "behavior must cover policy: it never takes action {action} at the observation {}, which policy takes with \
         probability {probability}",
        shown.unwrap_or_default()
    ))
}
