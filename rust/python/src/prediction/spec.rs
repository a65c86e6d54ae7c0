//! What is estimated, and by which method: `PredictionSpec` of `qtab/_spec.py`.

use std::sync::Arc;

use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use qtab_core::StopFlag;
use qtab_core::learners::LearnerVisitor;
use qtab_core::memory::{AllocationError, collect};
use qtab_core::prediction::{
    BatchTd, FixedPolicy, ImportanceSampling, LinearValues, MonteCarloPrediction, NStepTd, OfflineLambdaReturn,
    PredictionRule, Predictor, StateRows, TdLambda, TdZero, TrueOnlineTdLambda,
};
use qtab_core::schedules::LearningRate;

use crate::error::{allocation, invalid};
use crate::spec::{Fields, LearningRateSpec, RunSpec, Variant};

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

/// A method, the policies and the features, which all runs share.
#[derive(Clone, Debug)]
pub(crate) struct PredictionSpec {
    method: MethodSpec,
    behavior: FixedPolicy,
    target: FixedPolicy,
    rows: StateRows,
    initial: Arc<[f64]>,
}

impl PredictionSpec {
    pub(crate) fn parse(fields: &Fields<'_>, num_actions: usize) -> PyResult<Self> {
        let policy = |name: &str| -> PyResult<FixedPolicy> {
            let array: PyReadonlyArray2<'_, f64> = fields.get(name)?;
            let values = array.as_slice()?;
            let possible = |row: &[f64]| row.iter().any(|&probability| probability > 0.0);
            if num_actions == 0
                || !values.len().is_multiple_of(num_actions)
                || !values.chunks(num_actions).all(possible)
            {
                return Err(invalid(name, format!("{num_actions} probabilities for each state"), "others"));
            }
            let values: Arc<[f64]> = collect(values.iter().copied()).map_err(allocation)?.into();
            Ok(FixedPolicy::new(values, num_actions))
        };
        let initial: PyReadonlyArray1<'_, f64> = fields.get("initial_weights")?;
        let initial: Arc<[f64]> = collect(initial.as_slice()?.iter().copied()).map_err(allocation)?.into();
        let rows: PyReadonlyArray2<'_, u32> = fields.get("rows")?;
        let n_active = rows.as_array().ncols();
        let rows: Arc<[u32]> = collect(rows.as_slice()?.iter().copied()).map_err(allocation)?.into();
        let n_weights = initial.len();
        let rows = StateRows::new(rows, n_active, n_weights).ok_or_else(|| {
            invalid("rows", format!("an array (states, n_active) of rows below {n_weights}"), "others")
        })?;
        let method = fields.nested("method")?.tagged(METHODS)?;
        Ok(Self { method, behavior: policy("behavior")?, target: policy("target")?, rows, initial })
    }

    /// Refuses rows for another number of states than the task has.
    pub(crate) fn check_states(&self, states: usize) -> PyResult<()> {
        if self.num_states() == states {
            return Ok(());
        }
        Err(invalid("rows", format!("rows for each of the {states} cells"), self.num_states()))
    }

    /// The number of states.
    fn num_states(&self) -> usize {
        self.rows.num_states()
    }

    /// The number of weights.
    pub(crate) fn n_weights(&self) -> usize {
        self.rows.n_weights()
    }

    /// Passes a learner before its first episode to `visitor`, with a type of its own for TD(0), whose steps are the shortest.
    pub(crate) fn visit<V: LearnerVisitor<[u32; 1]>>(
        &self,
        spec: &RunSpec,
        stop: &StopFlag<'_>,
        visitor: V,
    ) -> PyResult<V::Output> {
        match self.method {
            MethodSpec::TdZero => Ok(visitor.visit(self.with_rule(TdZero, spec, stop)?)),
            _ => Ok(visitor.visit(self.predictor(spec, stop)?)),
        }
    }

    /// A learner before its first episode, of any method.
    pub(crate) fn predictor(
        &self,
        spec: &RunSpec,
        stop: &StopFlag<'_>,
    ) -> PyResult<Predictor<Box<dyn PredictionRule + Send>>> {
        let (states, weights) = (self.num_states(), self.n_weights());
        let rule: Box<dyn PredictionRule + Send> = match self.method {
            MethodSpec::TdZero => Box::new(TdZero),
            MethodSpec::NStepTd { n_steps } => Box::new(NStepTd::new(n_steps)),
            MethodSpec::TdLambda { trace_decay } => Box::new(TdLambda::new(trace_decay, weights)),
            MethodSpec::TrueOnlineTdLambda { trace_decay } => Box::new(TrueOnlineTdLambda::new(trace_decay, weights)),
            MethodSpec::OfflineLambdaReturn { trace_decay } => Box::new(OfflineLambdaReturn::new(trace_decay, states)),
            MethodSpec::MonteCarlo { first_visit } => Box::new(MonteCarloPrediction::new(first_visit, states)),
            MethodSpec::ImportanceSampling { weighted, first_visit } => {
                let (target, behavior) = (self.target.clone(), self.behavior.clone());
                Box::new(ImportanceSampling::new(weighted, first_visit, target, behavior, (states, weights)))
            }
            MethodSpec::BatchTd => Box::new(BatchTd::new(weights)),
        };
        self.with_rule(rule, spec, stop)
    }

    fn with_rule<U>(&self, rule: U, spec: &RunSpec, stop: &StopFlag<'_>) -> PyResult<Predictor<U>> {
        let learning_rate = self.learning_rate(spec, stop).map_err(allocation)?;
        let weights = collect(self.initial.iter().copied()).map_err(allocation)?;
        let values = LinearValues::new(weights, self.rows.clone(), learning_rate, spec.discount);
        Ok(Predictor { values, behavior: self.behavior.clone(), rule })
    }

    fn learning_rate(&self, spec: &RunSpec, stop: &StopFlag<'_>) -> Result<LearningRate, AllocationError> {
        let n_active = self.rows.n_active();
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
