//! The method of a prediction: `MethodSpec` of `qtab/_spec.py`.

use pyo3::prelude::*;
use qtab_core::StopFlag;
use qtab_core::prediction::{
    BatchTd, EmphaticTd, GradientTd, GradientTdKind, ImportanceSampling, Lstd, NStepTd, OffPolicyTd,
    OfflineLambdaReturn, PredictionRule, TdLambda, TdZero, TrueOnlineTdLambda,
};
use qtab_core::schedules::LearningRate;

use crate::error::{allocation, invalid};
use crate::spec::{Fields, Variant};

/// A method with its options.
#[derive(Clone, Copy, Debug)]
pub(super) enum MethodSpec {
    TdZero,
    NStepTd { n_steps: usize },
    TdLambda { trace_decay: f64 },
    TrueOnlineTdLambda { trace_decay: f64 },
    OfflineLambdaReturn { trace_decay: f64 },
    MonteCarlo { first_visit: bool },
    ImportanceSampling { weighted: bool, first_visit: bool },
    BatchTd,
    OffPolicyTd,
    OffPolicyTdLambda { trace_decay: f64 },
    GradientTd { kind: GradientTdKind, second_learning_rate: f64 },
    EmphaticTd,
    Lstd { trace_decay: f64, epsilon: f64, recursive: bool },
}

/// Every method by its name. `qtab.prediction.METHODS` lists the same names.
pub(super) const METHODS: &[Variant<MethodSpec>] = &[
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
    ("off_policy_td", |_| Ok(MethodSpec::OffPolicyTd)),
    ("off_policy_td_lambda", |fields| Ok(MethodSpec::OffPolicyTdLambda { trace_decay: fields.get("trace_decay")? })),
    ("gtd2", |fields| MethodSpec::gradient_td(GradientTdKind::Gtd2, fields)),
    ("tdc", |fields| MethodSpec::gradient_td(GradientTdKind::Tdc, fields)),
    ("emphatic_td", |_| Ok(MethodSpec::EmphaticTd)),
    ("lstd", |fields| {
        let (epsilon, recursive): (f64, bool) = (fields.get("epsilon")?, fields.get("recursive")?);
        if !(epsilon > 0.0 && epsilon.is_finite() && (!recursive || (1.0 / epsilon).is_finite())) {
            return Err(invalid(&fields.path("epsilon"), "above 0, with a finite reciprocal if recursive", epsilon));
        }
        Ok(MethodSpec::Lstd { trace_decay: fields.get("trace_decay")?, epsilon, recursive })
    }),
];

impl MethodSpec {
    fn gradient_td(kind: GradientTdKind, fields: &Fields<'_>) -> PyResult<Self> {
        Ok(Self::GradientTd { kind, second_learning_rate: fields.get("second_learning_rate")? })
    }

    /// Whether the method has a meaning for features with values other than 1.
    pub(super) fn takes_weighted(self) -> bool {
        !matches!(self, Self::ImportanceSampling { .. } | Self::BatchTd)
    }

    /// Whether the method uses the importance sampling ratios of a behavior policy.
    pub(super) fn uses_ratios(self) -> bool {
        matches!(
            self,
            Self::ImportanceSampling { .. }
                | Self::OffPolicyTd
                | Self::OffPolicyTdLambda { .. }
                | Self::GradientTd { .. }
                | Self::EmphaticTd
        )
    }

    /// Why values of the method diverge, and what helps.
    pub(super) fn divergence(self) -> &'static str {
        match self {
            Self::TdZero | Self::NStepTd { .. } | Self::MonteCarlo { .. } => {
                "the updates grow instead of settling; a smaller learning_rate helps"
            }
            Self::TdLambda { .. } | Self::TrueOnlineTdLambda { .. } | Self::OfflineLambdaReturn { .. } => {
                "the updates grow instead of settling; a smaller learning_rate, trace_decay or discount helps"
            }
            Self::ImportanceSampling { .. } => {
                "the importance sampling ratios of long episodes overflow; a smaller max_episode_steps helps, or a \
                 behavior closer to the policy"
            }
            Self::BatchTd => {
                "the values of states from which no episode ends have no limit; a discount below 1 helps, or episodes \
                 that end"
            }
            Self::OffPolicyTd | Self::OffPolicyTdLambda { .. } => {
                "the updates grow instead of settling; a smaller learning_rate may help, but off policy this method can \
                 diverge with any learning rate: 'tdc' does not if both of its learning rates are small"
            }
            Self::GradientTd { .. } => {
                "the updates grow instead of settling; a smaller learning_rate helps, and a smaller \
                 second_learning_rate if that is above it"
            }
            Self::EmphaticTd => {
                "the updates or the emphasis grow instead of settling; a smaller learning_rate or discount helps"
            }
            Self::Lstd { .. } => "the equations have no finite solution; a larger epsilon helps",
        }
    }

    /// The method before its first episode, for so many numbered states, 0 if they are not numbered, and so many weights.
    /// `constant` makes a constant learning rate of these features.
    pub(super) fn rule(
        self,
        (states, weights): (usize, usize),
        constant: impl FnOnce(f64) -> LearningRate,
        stop: &StopFlag<'_>,
    ) -> PyResult<Box<dyn PredictionRule + Send>> {
        Ok(match self {
            Self::TdZero => Box::new(TdZero),
            Self::NStepTd { n_steps } => Box::new(NStepTd::new(n_steps)),
            Self::TdLambda { trace_decay } => Box::new(TdLambda::new(trace_decay, weights)),
            Self::TrueOnlineTdLambda { trace_decay } => Box::new(TrueOnlineTdLambda::new(trace_decay, weights)),
            Self::OfflineLambdaReturn { trace_decay } => Box::new(OfflineLambdaReturn::new(trace_decay, states)),
            Self::MonteCarlo { first_visit } => Box::new(OfflineLambdaReturn::monte_carlo(first_visit, states)),
            Self::ImportanceSampling { weighted, first_visit } => {
                Box::new(ImportanceSampling::new(weighted, first_visit, (states, weights)))
            }
            Self::BatchTd => Box::new(BatchTd::new(weights)),
            Self::OffPolicyTd => Box::new(OffPolicyTd::new(weights)),
            Self::OffPolicyTdLambda { trace_decay } => Box::new(TdLambda::off_policy(trace_decay, weights)),
            Self::GradientTd { kind, second_learning_rate } => {
                Box::new(GradientTd::new(kind, constant(second_learning_rate), weights))
            }
            Self::EmphaticTd => Box::new(EmphaticTd::new(weights)),
            Self::Lstd { trace_decay, epsilon, recursive } => {
                Box::new(Lstd::new(trace_decay, epsilon, recursive, weights, stop).map_err(allocation)?)
            }
        })
    }
}
