//! The quantity to estimate, and the method: `PredictionSpec` of `qtab/_spec.py`.

use std::sync::Arc;

use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use qtab_core::StopFlag;
use qtab_core::memory::collect;
use qtab_core::prediction::{
    ActionFromTask, BatchTd, FixedPolicy, ImportanceSampling, LinearValues, NStepTd, OfflineLambdaReturn,
    PredictionRule, Predictor, StateFeatures, TdLambda, TdZero, TrueOnlineTdLambda,
};

use super::observation_policy::{ObservationPolicies, ObservationPolicySpec, POLICIES, check_probabilities};
use crate::convert::in_c_order;
use crate::error::{allocation, invalid};
use crate::spec::{DiscretizerSpec, Fields, RunSpec, Variant};

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

/// The policy that acts, and the policy that is evaluated.
#[derive(Clone, Debug)]
enum PoliciesSpec {
    /// Probabilities for each state.
    OfStates(FixedPolicy),
    /// Policies that read the observations of a Box. Without a target policy, the behavior policy is evaluated.
    OfObservations { behavior: ObservationPolicySpec, target: Option<ObservationPolicySpec> },
}

/// A method, the policies and the features, which all runs share.
#[derive(Debug)]
pub(crate) struct PredictionSpec {
    method: MethodSpec,
    policies: PoliciesSpec,
    /// The features of each cell; `None` if the features of an observation are its active rows.
    features: Option<StateFeatures>,
    initial: Arc<[f64]>,
}

/// A learner by any method.
type AnyPredictor<B> = Predictor<dyn PredictionRule + Send, B>;

impl PredictionSpec {
    pub(crate) fn parse(fields: &Fields<'_>, num_actions: usize) -> PyResult<Self> {
        let initial: PyReadonlyArray1<'_, f64> = fields.get("initial_weights")?;
        let initial = in_c_order(&initial)?;
        let rows: Option<PyReadonlyArray2<'_, u32>> = fields.get("rows")?;
        let features = match rows {
            None => None,
            Some(rows) => {
                let rows = rows.as_array();
                let numbers = collect(rows.iter().copied()).map_err(allocation)?;
                let features = StateFeatures::of_states(numbers, rows.ncols(), initial.len());
                let expected = || format!("an array (states, n_active) of rows below {}", initial.len());
                Some(features.ok_or_else(|| invalid("rows", expected(), "others"))?)
            }
        };
        let method = fields.nested("method")?.tagged(METHODS)?;
        let policies = if fields.any("policies")?.is_none() {
            let probabilities = |name| {
                let array: PyReadonlyArray2<'_, f64> = fields.get(name)?;
                let probabilities = in_c_order(&array)?;
                check_probabilities(name, &probabilities, num_actions, None)?;
                PyResult::Ok(probabilities)
            };
            let behavior = FixedPolicy::new(probabilities("behavior")?, num_actions);
            let target = probabilities("target")?;
            let is_off_policy = matches!(method, MethodSpec::ImportanceSampling { .. });
            PoliciesSpec::OfStates(if is_off_policy { behavior.evaluating(target) } else { behavior })
        } else {
            let policies = fields.nested("policies")?;
            let target = policies.any("target")?;
            let target = if target.is_none() { None } else { Some(policies.nested("target")?.tagged(POLICIES)?) };
            PoliciesSpec::OfObservations { behavior: policies.nested("behavior")?.tagged(POLICIES)?, target }
        };
        if features.is_none() && matches!(policies, PoliciesSpec::OfStates(_)) {
            return Err(invalid("rows", "given for policies of numbered states", "None"));
        }
        Ok(Self { method, policies, features, initial })
    }

    /// Whether the policies read observations instead of state numbers.
    pub(crate) fn reads_observations(&self) -> bool {
        matches!(self.policies, PoliciesSpec::OfObservations { .. })
    }

    /// Whether a Python function is called at each step.
    pub(crate) fn calls_python(&self) -> bool {
        match &self.policies {
            PoliciesSpec::OfStates(_) => false,
            PoliciesSpec::OfObservations { behavior, target } => {
                target.iter().chain([behavior]).any(ObservationPolicySpec::calls_python)
            }
        }
    }

    /// The policies that read observations. `rows` makes the row finder of a discretizer.
    pub(crate) fn policies<G>(
        &self,
        spec: &RunSpec,
        rows: impl Fn(&DiscretizerSpec) -> PyResult<G>,
    ) -> PyResult<ObservationPolicies<G>> {
        let PoliciesSpec::OfObservations { behavior, target } = &self.policies else {
            return Err(invalid("policies", "those of observations", "those of states"));
        };
        let build = |policy: &ObservationPolicySpec| policy.build(spec.num_actions, &spec.discretizer, &rows);
        let target = target.as_ref().map(build).transpose()?;
        Ok(ObservationPolicies { behavior: build(behavior)?, target, num_actions: spec.num_actions })
    }

    /// Checks that there are rows for the task's number of states.
    pub(crate) fn check_states(&self, states: usize) -> PyResult<()> {
        if self.num_states() == states {
            return Ok(());
        }
        Err(invalid("rows", format!("rows for each of the {states} cells"), self.num_states()))
    }

    /// The number of states; 0 if they are not numbered.
    fn num_states(&self) -> usize {
        self.features.as_ref().map_or(0, StateFeatures::num_states)
    }

    /// The number of weights.
    pub(crate) fn n_weights(&self) -> usize {
        self.initial.len()
    }

    /// A learner for numbered states, before its first episode.
    pub(crate) fn of_states(&self, spec: &RunSpec, stop: &StopFlag<'_>) -> PyResult<AnyPredictor<FixedPolicy>> {
        let (behavior, features) = self.numbered()?;
        self.predictor(self.rule(), behavior, features, spec, stop)
    }

    /// Like [`Self::of_states`], with a separate type for TD(0), whose steps are the shortest; `None` for other
    /// methods.
    pub(crate) fn td_zero(&self, spec: &RunSpec, stop: &StopFlag<'_>) -> PyResult<Option<Predictor<TdZero>>> {
        let MethodSpec::TdZero = self.method else { return Ok(None) };
        let (behavior, features) = self.numbered()?;
        self.predictor(Box::new(TdZero), behavior, features, spec, stop).map(Some)
    }

    /// A learner before its first episode, whose actions come from its task.
    pub(crate) fn of_observations(
        &self,
        spec: &RunSpec,
        stop: &StopFlag<'_>,
    ) -> PyResult<AnyPredictor<ActionFromTask>> {
        let (rule, num_rows) = (self.rule(), spec.discretizer.num_rows());
        let features = match &self.features {
            Some(features) => {
                self.check_states(num_rows)?;
                features.try_clone().map_err(allocation)?
            }
            None if self.n_weights() == num_rows => {
                StateFeatures::of_visits(spec.discretizer.n_active(), num_rows, rule.look_back()).map_err(allocation)?
            }
            None => return Err(invalid("initial_weights", format!("{num_rows} of them"), self.n_weights())),
        };
        self.predictor(rule, ActionFromTask, features, spec, stop)
    }

    /// The policy that acts, and the features of the states.
    fn numbered(&self) -> PyResult<(FixedPolicy, StateFeatures)> {
        match (&self.policies, &self.features) {
            (PoliciesSpec::OfStates(behavior), Some(features)) => {
                Ok((behavior.clone(), features.try_clone().map_err(allocation)?))
            }
            _ => Err(invalid("policies", "those of states", "those of observations")),
        }
    }

    fn rule(&self) -> Box<dyn PredictionRule + Send> {
        let (states, weights) = (self.num_states(), self.n_weights());
        match self.method {
            MethodSpec::TdZero => Box::new(TdZero),
            MethodSpec::NStepTd { n_steps } => Box::new(NStepTd::new(n_steps)),
            MethodSpec::TdLambda { trace_decay } => Box::new(TdLambda::new(trace_decay, weights)),
            MethodSpec::TrueOnlineTdLambda { trace_decay } => Box::new(TrueOnlineTdLambda::new(trace_decay, weights)),
            MethodSpec::OfflineLambdaReturn { trace_decay } => Box::new(OfflineLambdaReturn::new(trace_decay, states)),
            MethodSpec::MonteCarlo { first_visit } => Box::new(OfflineLambdaReturn::monte_carlo(first_visit, states)),
            MethodSpec::ImportanceSampling { weighted, first_visit } => {
                Box::new(ImportanceSampling::new(weighted, first_visit, (states, weights)))
            }
            MethodSpec::BatchTd => Box::new(BatchTd::new(weights)),
        }
    }

    fn predictor<U: ?Sized, B>(
        &self,
        rule: Box<U>,
        behavior: B,
        features: StateFeatures,
        spec: &RunSpec,
        stop: &StopFlag<'_>,
    ) -> PyResult<Predictor<U, B>> {
        let n_active = features.n_active();
        let rate = spec.learning_rate.build(spec.episodes, self.n_weights(), n_active, stop).map_err(allocation)?;
        let weights = collect(self.initial.iter().copied()).map_err(allocation)?;
        Ok(Predictor::new(LinearValues::new(weights, features, rate, spec.discount), behavior, rule))
    }
}
