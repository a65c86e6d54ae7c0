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
        if matches!(self, Self::DoubleQLearning) { 2 } else { 1 }
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
