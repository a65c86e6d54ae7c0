//! Which learner is trained, with its own options.

use pyo3::prelude::*;
use qtab_core::learners::TraceKind;

use super::fields::{Fields, Variant};
use crate::error::invalid;

#[derive(Clone, Copy, Debug)]
pub(crate) enum AlgorithmSpec {
    QLearning,
    Sarsa,
    ExpectedSarsa,
    DoubleQLearning,
    NStepSarsa { n_steps: usize },
    SarsaLambda(TraceSpec),
    TrueOnlineSarsaLambda { trace_decay: f64, trace_cutoff: f64 },
    WatkinsQLambda(TraceSpec),
    DynaQ { planning_steps: u32 },
    DynaQPlus { planning_steps: u32, time_weight: f64 },
    GradientBandit { baseline: bool },
    Reinforce,
    ReinforceWithBaseline { value_learning_rate: f64 },
    ActorCritic { value_learning_rate: f64 },
    ActorCriticLambda { value_learning_rate: f64, trace_decay: f64 },
}

/// Eligibility traces.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TraceSpec {
    pub(crate) kind: TraceKind,
    pub(crate) decay: f64,
    pub(crate) cutoff: f64,
}

/// Every algorithm by its name. `qtab.config` lists the same names; a test compares the two lists.
pub(crate) const ALGORITHMS: &[Variant<AlgorithmSpec>] = &[
    ("q_learning", |_| Ok(AlgorithmSpec::QLearning)),
    ("sarsa", |_| Ok(AlgorithmSpec::Sarsa)),
    ("expected_sarsa", |_| Ok(AlgorithmSpec::ExpectedSarsa)),
    ("double_q_learning", |_| Ok(AlgorithmSpec::DoubleQLearning)),
    ("n_step_sarsa", n_step_sarsa),
    ("sarsa_lambda", |fields| TraceSpec::parse(fields).map(AlgorithmSpec::SarsaLambda)),
    ("true_online_sarsa_lambda", |fields| {
        let (trace_decay, trace_cutoff) = (fields.get("trace_decay")?, fields.get("trace_cutoff")?);
        Ok(AlgorithmSpec::TrueOnlineSarsaLambda { trace_decay, trace_cutoff })
    }),
    ("watkins_q_lambda", |fields| TraceSpec::parse(fields).map(AlgorithmSpec::WatkinsQLambda)),
    ("dyna_q", |fields| Ok(AlgorithmSpec::DynaQ { planning_steps: fields.get("planning_steps")? })),
    ("dyna_q_plus", |fields| {
        let (planning_steps, time_weight) = (fields.get("planning_steps")?, fields.get("time_weight")?);
        Ok(AlgorithmSpec::DynaQPlus { planning_steps, time_weight })
    }),
    ("gradient_bandit", |fields| Ok(AlgorithmSpec::GradientBandit { baseline: fields.get("baseline")? })),
    ("reinforce", |_| Ok(AlgorithmSpec::Reinforce)),
    ("reinforce_with_baseline", |fields| {
        Ok(AlgorithmSpec::ReinforceWithBaseline { value_learning_rate: fields.get("value_learning_rate")? })
    }),
    ("actor_critic", |fields| {
        Ok(AlgorithmSpec::ActorCritic { value_learning_rate: fields.get("value_learning_rate")? })
    }),
    ("actor_critic_lambda", |fields| {
        let (value_learning_rate, trace_decay) = (fields.get("value_learning_rate")?, fields.get("trace_decay")?);
        Ok(AlgorithmSpec::ActorCriticLambda { value_learning_rate, trace_decay })
    }),
];

fn n_step_sarsa(fields: &Fields<'_>) -> PyResult<AlgorithmSpec> {
    match fields.get("n_steps")? {
        0 => Err(invalid(&fields.path("n_steps"), "at least 1", 0)),
        n_steps => Ok(AlgorithmSpec::NStepSarsa { n_steps }),
    }
}

impl AlgorithmSpec {
    pub(crate) fn parse(fields: &Fields<'_>) -> PyResult<Self> {
        fields.tagged(ALGORITHMS)
    }

    /// How many tables the algorithm learns.
    pub(crate) fn n_tables(&self) -> usize {
        if matches!(self, Self::DoubleQLearning) || self.value_learning_rate().is_some() { 2 } else { 1 }
    }

    /// The step size of the state values; None for an algorithm that learns none.
    pub(crate) fn value_learning_rate(&self) -> Option<f64> {
        match *self {
            Self::ReinforceWithBaseline { value_learning_rate }
            | Self::ActorCritic { value_learning_rate }
            | Self::ActorCriticLambda { value_learning_rate, .. } => Some(value_learning_rate),
            _ => None,
        }
    }

    /// Whether the algorithm learns preferences, of which the policy is the softmax.
    pub(crate) fn learns_preferences(&self) -> bool {
        matches!(self, Self::GradientBandit { .. } | Self::Reinforce) || self.value_learning_rate().is_some()
    }

    /// Whether the algorithm works with one active row only.
    pub(crate) fn needs_a_table(&self) -> bool {
        matches!(self, Self::DynaQ { .. } | Self::DynaQPlus { .. } | Self::GradientBandit { .. })
    }
}

impl TraceSpec {
    fn parse(fields: &Fields<'_>) -> PyResult<Self> {
        let kinds = [
            ("accumulating", TraceKind::Accumulating),
            ("replacing", TraceKind::Replacing),
            ("clearing", TraceKind::Clearing),
        ];
        let kind = fields.word("traces", &kinds)?;
        Ok(Self { kind, decay: fields.get("trace_decay")?, cutoff: fields.get("trace_cutoff")? })
    }
}
