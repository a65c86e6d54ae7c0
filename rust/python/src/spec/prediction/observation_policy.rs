//! Policies that choose by the observation of a Box: `ObservationPolicySpec` of `qtab/_spec.py`.

use std::sync::Arc;

use numpy::{PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyBool;
use qtab_core::prediction::ObservationPolicy;
use qtab_core::random::Rng;

use super::action_values::ActionValues;
use super::policy_features::ReadValues;
use super::py_observation::PyObservation;
use crate::convert::in_c_order;
use crate::error::{RunError, invalid};
use crate::spec::{DiscretizerSpec, Fields, Variant};

/// The description of a policy, before it reads observations.
#[derive(Clone, Debug)]
pub(crate) enum ObservationPolicySpec {
    /// The same probabilities everywhere, or separate ones for each cell of the task's discretizer.
    Table { probabilities: Arc<[f64]>, is_everywhere: bool },
    /// The action with the largest value, added over one or several tables.
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

    /// The policy, where `own` is the task's discretizer. `features` makes the features of a discretizer.
    pub(super) fn build<G>(
        &self,
        num_actions: usize,
        own: &DiscretizerSpec,
        features: impl Fn(&DiscretizerSpec) -> PyResult<G>,
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
                let is_weighted = discretizer.weighted().is_some();
                let values = ActionValues::new(Arc::clone(tables), discretizer.num_rows(), num_actions, is_weighted);
                let values = values.ok_or_else(|| invalid("discretizer", "fewer features", discretizer.num_rows()))?;
                PolicyReader::Greedy { features: features(discretizer)?, values }
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
    Table { probabilities: Arc<[f64]>, is_everywhere: bool, is_deterministic: bool },
    Greedy { features: G, values: ActionValues },
    Function(Arc<FunctionSpec>),
}

impl<G> ReadPolicy<G> {
    /// `own` is the row of the observation in the task's discretizer.
    fn read<O: PyObservation>(&mut self, observation: &O, own: u32) -> Result<(), RunError>
    where
        G: ReadValues<O>,
    {
        match &mut self.reader {
            PolicyReader::Table { probabilities, is_everywhere, is_deterministic } => {
                let (row, count) = (if *is_everywhere { 0 } else { own as usize }, self.probabilities.len());
                self.probabilities.copy_from_slice(&probabilities[row * count..][..count]);
                let possible = self.probabilities.iter().position(|&probability| probability > 0.0);
                self.action = possible.filter(|_| *is_deterministic);
            }
            PolicyReader::Greedy { features, values } => {
                features.read_values(observation, values)?;
                self.action = Some(values.best());
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

/// The policy that acts and, off policy, the policy that is evaluated.
pub(crate) struct ObservationPolicies<G> {
    pub(super) behavior: ReadPolicy<G>,
    pub(super) target: Option<ReadPolicy<G>>,
    pub(super) num_actions: usize,
}

/// The number of Q-learning steps on a grid that a call of a Python function counts as.
const CALL_WORK: u64 = 127;

/// The number of products of features and weights in the time of such a step.
const PRODUCTS_PER_WORK: u64 = 8;

impl<O: PyObservation, G: ReadValues<O>> ObservationPolicy<O> for ObservationPolicies<G> {
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
        let work = |policy: &ReadPolicy<G>| match &policy.reader {
            PolicyReader::Table { .. } => 0,
            PolicyReader::Greedy { values, .. } => values.products() as u64 / PRODUCTS_PER_WORK,
            PolicyReader::Function(_) => CALL_WORK,
        };
        policies.map(work).sum()
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
