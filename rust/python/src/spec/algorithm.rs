//! Which learner is trained, with its own options.

use pyo3::prelude::*;
use qtab_core::learners::{TargetPolicy, TraceKind};

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
    DynaQ { planning_steps: u32, stochastic: bool },
    DynaQPlus { planning_steps: u32, time_weight: f64 },
    MonteCarlo,
    MonteCarloEs,
    OffPolicyMonteCarlo,
    NStepTreeBackup { n_steps: usize, target_policy: TargetPolicy },
    NStepQSigma { n_steps: usize, sigma: f64, target_policy: TargetPolicy },
    PrioritizedSweeping { planning_steps: u32, priority_threshold: f64 },
    DifferentialSarsa { reward_learning_rate: f64 },
    DifferentialQLearning { reward_learning_rate: f64 },
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
    ("n_step_sarsa", |fields| n_steps(fields).map(|n_steps| AlgorithmSpec::NStepSarsa { n_steps })),
    ("sarsa_lambda", |fields| TraceSpec::parse(fields).map(AlgorithmSpec::SarsaLambda)),
    ("true_online_sarsa_lambda", |fields| {
        let (trace_decay, trace_cutoff) = (fields.get("trace_decay")?, fields.get("trace_cutoff")?);
        Ok(AlgorithmSpec::TrueOnlineSarsaLambda { trace_decay, trace_cutoff })
    }),
    ("watkins_q_lambda", |fields| TraceSpec::parse(fields).map(AlgorithmSpec::WatkinsQLambda)),
    ("dyna_q", |fields| {
        let stochastic = fields.word("model", &[("deterministic", false), ("stochastic", true)])?;
        Ok(AlgorithmSpec::DynaQ { planning_steps: fields.get("planning_steps")?, stochastic })
    }),
    ("dyna_q_plus", |fields| {
        let (planning_steps, time_weight) = (fields.get("planning_steps")?, fields.get("time_weight")?);
        Ok(AlgorithmSpec::DynaQPlus { planning_steps, time_weight })
    }),
    ("monte_carlo", |_| Ok(AlgorithmSpec::MonteCarlo)),
    ("monte_carlo_es", |_| Ok(AlgorithmSpec::MonteCarloEs)),
    ("off_policy_monte_carlo", |_| Ok(AlgorithmSpec::OffPolicyMonteCarlo)),
    ("n_step_tree_backup", |fields| {
        let (n_steps, target_policy) = (n_steps(fields)?, target_policy(fields)?);
        Ok(AlgorithmSpec::NStepTreeBackup { n_steps, target_policy })
    }),
    ("n_step_q_sigma", |fields| {
        let (n_steps, target_policy) = (n_steps(fields)?, target_policy(fields)?);
        Ok(AlgorithmSpec::NStepQSigma { n_steps, sigma: fields.get("sigma")?, target_policy })
    }),
    ("prioritized_sweeping", |fields| {
        let (planning_steps, priority_threshold) = (fields.get("planning_steps")?, fields.get("priority_threshold")?);
        Ok(AlgorithmSpec::PrioritizedSweeping { planning_steps, priority_threshold })
    }),
    ("differential_sarsa", |fields| {
        Ok(AlgorithmSpec::DifferentialSarsa { reward_learning_rate: fields.get("reward_learning_rate")? })
    }),
    ("differential_q_learning", |fields| {
        Ok(AlgorithmSpec::DifferentialQLearning { reward_learning_rate: fields.get("reward_learning_rate")? })
    }),
];

fn n_steps(fields: &Fields<'_>) -> PyResult<usize> {
    match fields.get("n_steps")? {
        0 => Err(invalid(&fields.path("n_steps"), "at least 1", 0)),
        n_steps => Ok(n_steps),
    }
}

fn target_policy(fields: &Fields<'_>) -> PyResult<TargetPolicy> {
    fields.word("target_policy", &[("greedy", TargetPolicy::Greedy), ("behavior", TargetPolicy::Behavior)])
}

impl AlgorithmSpec {
    pub(crate) fn parse(fields: &Fields<'_>) -> PyResult<Self> {
        fields.tagged(ALGORITHMS)
    }

    /// Whether it needs a table with one row for each state.
    pub(crate) fn needs_table(&self) -> bool {
        matches!(
            self,
            Self::DynaQ { .. }
                | Self::DynaQPlus { .. }
                | Self::MonteCarlo
                | Self::MonteCarloEs
                | Self::OffPolicyMonteCarlo
                | Self::PrioritizedSweeping { .. }
        )
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
