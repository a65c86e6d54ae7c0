//! Which learner is trained, with its own options.

use pyo3::prelude::*;
use qtab_core::learners::{AnyAlgorithm, TraceKind, TraceOptions};

use super::fields::{Fields, Variant};
use crate::error::invalid;

/// Every algorithm by its name. `qtab.config` lists the same names; a test compares the two lists.
pub(crate) const ALGORITHMS: &[Variant<AnyAlgorithm>] = &[
    ("q_learning", |_| Ok(AnyAlgorithm::QLearning)),
    ("sarsa", |_| Ok(AnyAlgorithm::Sarsa)),
    ("expected_sarsa", |_| Ok(AnyAlgorithm::ExpectedSarsa)),
    ("double_q_learning", |_| Ok(AnyAlgorithm::DoubleQLearning)),
    ("n_step_sarsa", n_step_sarsa),
    ("sarsa_lambda", |fields| trace_options(fields).map(AnyAlgorithm::SarsaLambda)),
    ("true_online_sarsa_lambda", |fields| {
        let (trace_decay, trace_cutoff) = (fields.get("trace_decay")?, fields.get("trace_cutoff")?);
        Ok(AnyAlgorithm::TrueOnlineSarsaLambda { trace_decay, trace_cutoff })
    }),
    ("watkins_q_lambda", |fields| trace_options(fields).map(AnyAlgorithm::WatkinsQLambda)),
    ("dyna_q", |fields| Ok(AnyAlgorithm::DynaQ { planning_steps: fields.get("planning_steps")? })),
    ("dyna_q_plus", |fields| {
        let (planning_steps, time_weight) = (fields.get("planning_steps")?, fields.get("time_weight")?);
        Ok(AnyAlgorithm::DynaQPlus { planning_steps, time_weight })
    }),
    ("gradient_bandit", |fields| Ok(AnyAlgorithm::GradientBandit { baseline: fields.get("baseline")? })),
    ("reinforce", |_| Ok(AnyAlgorithm::Reinforce)),
    ("reinforce_with_baseline", |fields| {
        Ok(AnyAlgorithm::ReinforceWithBaseline { value_learning_rate: fields.get("value_learning_rate")? })
    }),
    ("actor_critic", |fields| {
        Ok(AnyAlgorithm::ActorCritic { value_learning_rate: fields.get("value_learning_rate")? })
    }),
    ("actor_critic_lambda", |fields| {
        let (value_learning_rate, trace_decay) = (fields.get("value_learning_rate")?, fields.get("trace_decay")?);
        Ok(AnyAlgorithm::ActorCriticLambda { value_learning_rate, trace_decay })
    }),
];

fn n_step_sarsa(fields: &Fields<'_>) -> PyResult<AnyAlgorithm> {
    match fields.get("n_steps")? {
        0 => Err(invalid(&fields.path("n_steps"), "at least 1", 0)),
        n_steps => Ok(AnyAlgorithm::NStepSarsa { n_steps }),
    }
}

/// Parses an algorithm by its name.
pub(crate) fn algorithm(fields: &Fields<'_>) -> PyResult<AnyAlgorithm> {
    fields.tagged(ALGORITHMS)
}

fn trace_options(fields: &Fields<'_>) -> PyResult<TraceOptions> {
    let kinds = [
        ("accumulating", TraceKind::Accumulating),
        ("replacing", TraceKind::Replacing),
        ("clearing", TraceKind::Clearing),
    ];
    let kind = fields.word("traces", &kinds)?;
    Ok(TraceOptions { kind, decay: fields.get("trace_decay")?, cutoff: fields.get("trace_cutoff")? })
}
