//! The quantity to estimate, and the method: `PredictionSpec` of `qtab/_spec.py`.

use std::sync::Arc;

use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use qtab_core::StopFlag;
use qtab_core::memory::collect;
use qtab_core::prediction::{
    ActionFromTask, FixedPolicy, LinearValues, PredictionRule, Predictor, StateFeatures, TdZero,
};
use qtab_core::schedules::{LearningRate, Schedule};

use super::method::{METHODS, MethodSpec};
use super::observation_policy::{ObservationPolicies, ObservationPolicySpec, POLICIES, check_probabilities};
use crate::convert::in_c_order;
use crate::error::{allocation, invalid};
use crate::spec::weighted::WeightedSpec;
use crate::spec::{DiscretizerSpec, Fields, RunSpec};

/// The policy that acts, and the policy that is evaluated.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one in a run")]
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
        let features = parse_features(fields, initial.len())?;
        let method: MethodSpec = fields.nested("method")?.tagged(METHODS)?;
        if features.as_ref().is_some_and(StateFeatures::is_weighted) && !method.takes_weighted() {
            return Err(invalid("method", "one that works with weighted features", "another"));
        }
        let policies = if fields.any("policies")?.is_none() {
            let probabilities = |name| {
                let array: PyReadonlyArray2<'_, f64> = fields.get(name)?;
                let probabilities = in_c_order(&array)?;
                check_probabilities(name, &probabilities, num_actions, None)?;
                PyResult::Ok(probabilities)
            };
            let behavior = FixedPolicy::new(probabilities("behavior")?, num_actions);
            let target = probabilities("target")?;
            PoliciesSpec::OfStates(if method.uses_ratios() { behavior.evaluating(target) } else { behavior })
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

    /// Whether the method has a meaning for features with values other than 1.
    pub(crate) fn takes_weighted(&self) -> bool {
        self.method.takes_weighted()
    }

    /// Why the values can diverge, and what helps.
    pub(crate) fn divergence(&self) -> &'static str {
        self.method.divergence()
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

    /// The policies that read observations. `features` makes the features of a discretizer.
    pub(crate) fn policies<G>(
        &self,
        spec: &RunSpec,
        features: impl Fn(&DiscretizerSpec) -> PyResult<G>,
    ) -> PyResult<ObservationPolicies<G>> {
        let PoliciesSpec::OfObservations { behavior, target } = &self.policies else {
            return Err(invalid("policies", "those of observations", "those of states"));
        };
        let build = |policy: &ObservationPolicySpec| policy.build(spec.num_actions, &spec.discretizer, &features);
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
        self.predictor(self.rule(spec, stop)?, behavior, features, spec, stop)
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
        let (rule, num_rows) = (self.rule(spec, stop)?, spec.discretizer.num_rows());
        let features = match &self.features {
            Some(_) if spec.discretizer.weighted().is_some() => {
                return Err(invalid(
                    "discretizer",
                    "one with a cell for each observation, with features of cells",
                    "another",
                ));
            }
            Some(features) => {
                self.check_states(num_rows)?;
                features.try_clone().map_err(allocation)?
            }
            None if self.n_weights() != num_rows => {
                return Err(invalid("initial_weights", format!("{num_rows} of them"), self.n_weights()));
            }
            None if spec.discretizer.weighted().is_some() => {
                StateFeatures::of_weighted_visits(num_rows, rule.look_back()).map_err(allocation)?
            }
            None => {
                StateFeatures::of_visits(spec.discretizer.n_active(), num_rows, rule.look_back()).map_err(allocation)?
            }
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

    fn rule(&self, spec: &RunSpec, stop: &StopFlag<'_>) -> PyResult<Box<dyn PredictionRule + Send>> {
        let divisors = self.divisors(spec)?;
        let constant = |value| {
            let schedule = Schedule::constant(value);
            match divisors {
                Some(divisors) if divisors.is_empty() => LearningRate::scheduled(schedule, 1),
                Some(divisors) => LearningRate::scaled_by_row(schedule, divisors),
                None => LearningRate::scheduled(schedule, self.n_active(spec)),
            }
        };
        self.method.rule((self.num_states(), self.n_weights()), constant, stop)
    }

    /// The numbers that divide the step sizes of weighted features; empty for one step size, `None` for binary features.
    fn divisors(&self, spec: &RunSpec) -> PyResult<Option<Vec<f64>>> {
        match &self.features {
            Some(features) => Ok(features.is_weighted().then(Vec::new)),
            None => spec.discretizer.weighted().map(WeightedSpec::step_size_divisors).transpose(),
        }
    }

    /// The number of active rows, which share the step size of binary features.
    fn n_active(&self, spec: &RunSpec) -> usize {
        self.features.as_ref().map_or_else(|| spec.discretizer.n_active(), StateFeatures::n_active)
    }

    /// The learning rate α.
    fn learning_rate(&self, spec: &RunSpec, stop: &StopFlag<'_>) -> PyResult<LearningRate> {
        let Some(divisors) = self.divisors(spec)? else {
            let rate = spec.learning_rate.build(spec.episodes, self.n_weights(), self.n_active(spec), stop);
            return rate.map_err(allocation);
        };
        let rate = spec.learning_rate.build_weighted(spec.episodes, divisors);
        rate.ok_or_else(|| invalid("learning_rate", "a schedule by the episode for weighted features", "'visits'"))
    }

    fn predictor<U: ?Sized, B>(
        &self,
        rule: Box<U>,
        behavior: B,
        features: StateFeatures,
        spec: &RunSpec,
        stop: &StopFlag<'_>,
    ) -> PyResult<Predictor<U, B>> {
        let rate = self.learning_rate(spec, stop)?;
        let weights = collect(self.initial.iter().copied()).map_err(allocation)?;
        Ok(Predictor::new(LinearValues::new(weights, features, rate, spec.discount), behavior, rule))
    }
}

/// The features of each state: active rows, or vectors of numbers; `None` if those of an observation are the features.
fn parse_features(fields: &Fields<'_>, n_weights: usize) -> PyResult<Option<StateFeatures>> {
    let rows: Option<PyReadonlyArray2<'_, u32>> = fields.get("rows")?;
    let vectors: Option<PyReadonlyArray2<'_, f64>> = fields.get("vectors")?;
    let (features, name, expected) = match (rows, vectors) {
        (None, None) => return Ok(None),
        (Some(rows), None) => {
            let rows = rows.as_array();
            let numbers = collect(rows.iter().copied()).map_err(allocation)?;
            let expected = format!("an array (states, n_active) of rows below {n_weights}");
            (StateFeatures::of_states(numbers, rows.ncols(), n_weights), "rows", expected)
        }
        (None, Some(vectors)) => {
            let vectors = vectors.as_array();
            let numbers = collect(vectors.iter().copied()).map_err(allocation)?;
            let features = StateFeatures::weighted(numbers, n_weights).filter(|_| vectors.ncols() == n_weights);
            (features, "vectors", format!("an array (states, {n_weights}) of finite numbers"))
        }
        (Some(_), Some(_)) => return Err(invalid("vectors", "None with rows", "an array")),
    };
    features.map(Some).ok_or_else(|| invalid(name, expected, "others"))
}
