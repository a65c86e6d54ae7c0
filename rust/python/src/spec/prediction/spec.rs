//! What is estimated, and by which method: `PredictionSpec` of `qtab/_spec.py`.

use std::sync::Arc;

use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use qtab_core::StopFlag;
use qtab_core::learners::LearnerVisitor;
use qtab_core::memory::{AllocationError, collect};
use qtab_core::prediction::{
    BatchTd, FixedPolicy, FromTask, ImportanceSampling, LinearValues, MonteCarloPrediction, NStepTd,
    OfflineLambdaReturn, PredictionRule, Predictor, Ratios, RowSets, StateRows, TdLambda, TdZero, TrueOnlineTdLambda,
    VisitRows,
};
use qtab_core::schedules::LearningRate;

use super::observation_policy::{ObservationPolicies, ObservationPolicySpec, POLICIES};
use crate::convert::in_c_order;
use crate::error::{allocation, invalid};
use crate::spec::{DiscretizerSpec, Fields, LearningRateSpec, RunSpec, Variant};

/// A method with its options.
#[derive(Clone, Copy, Debug)]
enum MethodSpec {
    TdZero,
    NStepTd { n_steps: usize },
    TdLambda { trace_decay: f64 },
    TrueOnlineTdLambda { trace_decay: f64 },
    OfflineLambdaReturn { trace_decay: f64 },
    MonteCarlo { first_visit: bool },
    ImportanceSampling { weighted: bool, first_visit: bool },
    BatchTd,
}

/// Every method by its name. `qtab.prediction.methods` lists the same names.
const METHODS: &[Variant<MethodSpec>] = &[
    ("td", |_| Ok(MethodSpec::TdZero)),
    ("n_step_td", |fields| match fields.get("n_steps")? {
        0 => Err(invalid(&fields.path("n_steps"), "at least 1", 0)),
        n_steps => Ok(MethodSpec::NStepTd { n_steps }),
    }),
    ("td_lambda", |fields| Ok(MethodSpec::TdLambda { trace_decay: fields.get("trace_decay")? })),
    ("true_online_td_lambda", |fields| Ok(MethodSpec::TrueOnlineTdLambda { trace_decay: fields.get("trace_decay")? })),
    ("offline_lambda_return", |fields| Ok(MethodSpec::OfflineLambdaReturn { trace_decay: fields.get("trace_decay")? })),
    ("monte_carlo", |fields| Ok(MethodSpec::MonteCarlo { first_visit: fields.get("first_visit")? })),
    ("importance_sampling", |fields| {
        Ok(MethodSpec::ImportanceSampling {
            weighted: fields.get("weighted")?,
            first_visit: fields.get("first_visit")?,
        })
    }),
    ("batch_td", |_| Ok(MethodSpec::BatchTd)),
];

/// Where the actions come from, and what is evaluated.
#[derive(Clone, Debug)]
enum PoliciesSpec {
    /// Probabilities for each state.
    OfStates { behavior: FixedPolicy, target: FixedPolicy },
    /// Policies that read the observations of a Box. The target policy is missing where it acts itself.
    OfObservations { behavior: ObservationPolicySpec, target: Option<ObservationPolicySpec> },
}

/// A method, the policies and the features, which all runs share.
#[derive(Clone, Debug)]
pub(crate) struct PredictionSpec {
    method: MethodSpec,
    policies: PoliciesSpec,
    /// The features of each cell; `None` where those of an observation are the active rows themselves.
    rows: Option<StateRows>,
    initial: Arc<[f64]>,
}

/// What makes something of a predictor whose actions come from its task, whatever the type of its features.
pub(crate) trait ObservedVisitor {
    type Output;

    fn visit<S>(self, learner: Predictor<Box<dyn PredictionRule<S> + Send>, FromTask, S>) -> Self::Output
    where
        S: RowSets + Send + 'static;
}

impl PredictionSpec {
    pub(crate) fn parse(fields: &Fields<'_>, num_actions: usize) -> PyResult<Self> {
        let initial: PyReadonlyArray1<'_, f64> = fields.get("initial_weights")?;
        let initial = in_c_order(&initial)?;
        let n_weights = initial.len();
        let rows: Option<PyReadonlyArray2<'_, u32>> = fields.get("rows")?;
        let rows = match rows {
            None => None,
            Some(given) => {
                let n_active = given.as_array().ncols();
                Some(StateRows::new(in_c_order(&given)?, n_active, n_weights).ok_or_else(|| {
                    invalid("rows", format!("an array (states, n_active) of rows below {n_weights}"), "others")
                })?)
            }
        };
        let policies = if fields.any("policies")?.is_none() {
            let (behavior, target) =
                (of_states(fields, "behavior", num_actions)?, of_states(fields, "target", num_actions)?);
            PoliciesSpec::OfStates { behavior, target }
        } else {
            let policies = fields.nested("policies")?;
            let target = policies.any("target")?;
            let target = if target.is_none() { None } else { Some(policies.nested("target")?.tagged(POLICIES)?) };
            PoliciesSpec::OfObservations { behavior: policies.nested("behavior")?.tagged(POLICIES)?, target }
        };
        if rows.is_none() && matches!(policies, PoliciesSpec::OfStates { .. }) {
            return Err(invalid("rows", "given for policies of numbered states", "None"));
        }
        Ok(Self { method: fields.nested("method")?.tagged(METHODS)?, policies, rows, initial })
    }

    /// Whether the policies read observations, rather than the numbers of states.
    pub(crate) fn reads_observations(&self) -> bool {
        matches!(self.policies, PoliciesSpec::OfObservations { .. })
    }

    /// Whether a function in Python is called at each step.
    pub(crate) fn calls_python(&self) -> bool {
        let is_function = |policy: &ObservationPolicySpec| matches!(policy, ObservationPolicySpec::Function(_));
        match &self.policies {
            PoliciesSpec::OfStates { .. } => false,
            PoliciesSpec::OfObservations { behavior, target } => {
                is_function(behavior) || target.as_ref().is_some_and(is_function)
            }
        }
    }

    /// The policies that read observations. `rows` makes what finds the rows of a discretizer.
    pub(crate) fn policies<G>(
        &self,
        spec: &RunSpec,
        rows: impl Fn(&DiscretizerSpec) -> PyResult<G>,
    ) -> PyResult<ObservationPolicies<G>> {
        let PoliciesSpec::OfObservations { behavior, target } = &self.policies else {
            return Err(invalid("policies", "those of observations", "those of states"));
        };
        let own = (&spec.discretizer, spec.discretizer.num_rows());
        let build = |policy: &ObservationPolicySpec| policy.build(spec.num_actions, own, &rows);
        let target = target.as_ref().map(build).transpose()?;
        Ok(ObservationPolicies { behavior: build(behavior)?, target, num_actions: spec.num_actions })
    }

    /// Refuses rows for another number of states than the task has.
    pub(crate) fn check_states(&self, states: usize) -> PyResult<()> {
        if self.num_states() == states {
            return Ok(());
        }
        Err(invalid("rows", format!("rows for each of the {states} cells"), self.num_states()))
    }

    /// The number of states; 0 where they have no numbers.
    fn num_states(&self) -> usize {
        self.rows.as_ref().map_or(0, StateRows::num_states)
    }

    /// The number of weights.
    pub(crate) fn n_weights(&self) -> usize {
        self.initial.len()
    }

    /// Passes a learner before its first episode to `visitor`, with a type of its own for TD(0), whose steps are the shortest.
    pub(crate) fn visit<V: LearnerVisitor<[u32; 1]>>(
        &self,
        spec: &RunSpec,
        stop: &StopFlag<'_>,
        visitor: V,
    ) -> PyResult<V::Output> {
        match self.method {
            MethodSpec::TdZero => {
                let (behavior, rows) = self.of_states()?;
                Ok(visitor.visit(self.with_rule(TdZero, behavior, rows, spec, stop)?))
            }
            _ => Ok(visitor.visit(self.predictor(spec, stop)?)),
        }
    }

    /// A learner before its first episode, of any method, in numbered states.
    pub(crate) fn predictor(
        &self,
        spec: &RunSpec,
        stop: &StopFlag<'_>,
    ) -> PyResult<Predictor<Box<dyn PredictionRule + Send>>> {
        let (behavior, rows) = self.of_states()?;
        self.with_rule(self.rule(), behavior, rows, spec, stop)
    }

    /// Passes a learner before its first episode to `visitor`, whose actions come from its task.
    pub(crate) fn visit_observed<V: ObservedVisitor>(
        &self,
        spec: &RunSpec,
        stop: &StopFlag<'_>,
        visitor: V,
    ) -> PyResult<V::Output> {
        if let Some(rows) = &self.rows {
            self.check_states(spec.discretizer.num_rows())?;
            return Ok(visitor.visit(self.with_rule(self.rule::<StateRows>(), FromTask, rows.clone(), spec, stop)?));
        }
        if self.n_weights() != spec.discretizer.num_rows() {
            let expected = format!("{} of them", spec.discretizer.num_rows());
            return Err(invalid("initial_weights", expected, self.n_weights()));
        }
        let rule = self.rule::<VisitRows>();
        let rows =
            VisitRows::new(spec.discretizer.n_active(), self.n_weights(), rule.look_back()).map_err(allocation)?;
        Ok(visitor.visit(self.with_rule(rule, FromTask, rows, spec, stop)?))
    }

    /// The policy that acts, and the features of the states.
    fn of_states(&self) -> PyResult<(FixedPolicy, StateRows)> {
        match (&self.policies, &self.rows) {
            (PoliciesSpec::OfStates { behavior, .. }, Some(rows)) => Ok((behavior.clone(), rows.clone())),
            _ => Err(invalid("policies", "those of states here", "those of observations")),
        }
    }

    fn rule<S: RowSets>(&self) -> Box<dyn PredictionRule<S> + Send> {
        let (states, weights) = (self.num_states(), self.n_weights());
        match self.method {
            MethodSpec::TdZero => Box::new(TdZero),
            MethodSpec::NStepTd { n_steps } => Box::new(NStepTd::new(n_steps)),
            MethodSpec::TdLambda { trace_decay } => Box::new(TdLambda::new(trace_decay, weights)),
            MethodSpec::TrueOnlineTdLambda { trace_decay } => Box::new(TrueOnlineTdLambda::new(trace_decay, weights)),
            MethodSpec::OfflineLambdaReturn { trace_decay } => Box::new(OfflineLambdaReturn::new(trace_decay, states)),
            MethodSpec::MonteCarlo { first_visit } => Box::new(MonteCarloPrediction::new(first_visit, states)),
            MethodSpec::ImportanceSampling { weighted, first_visit } => {
                let ratios = match &self.policies {
                    PoliciesSpec::OfStates { behavior, target } => {
                        Ratios::OfTables { target: target.clone(), behavior: behavior.clone() }
                    }
                    PoliciesSpec::OfObservations { .. } => Ratios::Given(Vec::new()),
                };
                Box::new(ImportanceSampling::new(weighted, first_visit, ratios, (states, weights)))
            }
            MethodSpec::BatchTd => Box::new(BatchTd::new(weights)),
        }
    }

    fn with_rule<U, B, S: RowSets>(
        &self,
        rule: U,
        behavior: B,
        rows: S,
        spec: &RunSpec,
        stop: &StopFlag<'_>,
    ) -> PyResult<Predictor<U, B, S>> {
        let learning_rate = self.learning_rate(rows.n_active(), spec, stop).map_err(allocation)?;
        let weights = collect(self.initial.iter().copied()).map_err(allocation)?;
        Ok(Predictor { values: LinearValues::new(weights, rows, learning_rate, spec.discount), behavior, rule })
    }

    fn learning_rate(
        &self,
        n_active: usize,
        spec: &RunSpec,
        stop: &StopFlag<'_>,
    ) -> Result<LearningRate, AllocationError> {
        match spec.learning_rate {
            LearningRateSpec::Schedule(schedule) => {
                Ok(LearningRate::scheduled(schedule.build(spec.episodes), n_active))
            }
            LearningRateSpec::Visits { value, minimum } => {
                LearningRate::by_visit_count(value, minimum, self.n_weights(), n_active, stop)
            }
        }
    }
}

/// A policy over numbered states: its probabilities.
fn of_states(fields: &Fields<'_>, name: &str, num_actions: usize) -> PyResult<FixedPolicy> {
    let array: PyReadonlyArray2<'_, f64> = fields.get(name)?;
    let values = in_c_order(&array)?;
    let possible = |row: &[f64]| row.iter().any(|&probability| probability > 0.0);
    if num_actions == 0 || !values.len().is_multiple_of(num_actions) || !values.chunks(num_actions).all(possible) {
        return Err(invalid(name, format!("{num_actions} probabilities for each state"), "others"));
    }
    Ok(FixedPolicy::new(values, num_actions))
}
