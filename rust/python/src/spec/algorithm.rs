//! Which learner is trained, with its own options.

use pyo3::prelude::*;
use qtab_core::learners::{AnyAlgorithm, TargetPolicy, TraceKind, TraceOptions};

use super::LearningRateSpec;
use super::fields::{Fields, Variant};
use crate::error::invalid;

/// Every algorithm by its name. `qtab.config` lists the same names; a test compares the two lists.
pub(crate) const ALGORITHMS: &[Variant<AnyAlgorithm>] = &[
    ("q_learning", |_| Ok(AnyAlgorithm::QLearning)),
    ("sarsa", |_| Ok(AnyAlgorithm::Sarsa)),
    ("expected_sarsa", |_| Ok(AnyAlgorithm::ExpectedSarsa)),
    ("double_q_learning", |_| Ok(AnyAlgorithm::DoubleQLearning)),
    ("n_step_sarsa", |fields| n_steps(fields).map(|n_steps| AnyAlgorithm::NStepSarsa { n_steps })),
    ("sarsa_lambda", |fields| trace_options(fields).map(AnyAlgorithm::SarsaLambda)),
    ("true_online_sarsa_lambda", |fields| {
        let (trace_decay, trace_cutoff) = (fields.get("trace_decay")?, fields.get("trace_cutoff")?);
        Ok(AnyAlgorithm::TrueOnlineSarsaLambda { trace_decay, trace_cutoff })
    }),
    ("watkins_q_lambda", |fields| trace_options(fields).map(AnyAlgorithm::WatkinsQLambda)),
    ("dyna_q", |fields| {
        let planning_steps = fields.get("planning_steps")?;
        let is_stochastic = fields.word("model", &[("deterministic", false), ("stochastic", true)])?;
        Ok(if is_stochastic {
            AnyAlgorithm::StochasticDynaQ { planning_steps }
        } else {
            AnyAlgorithm::DynaQ { planning_steps }
        })
    }),
    ("dyna_q_plus", |fields| {
        let (planning_steps, time_weight) = (fields.get("planning_steps")?, fields.get("time_weight")?);
        Ok(AnyAlgorithm::DynaQPlus { planning_steps, time_weight })
    }),
    // The settings of a run that some of them need besides are filled in afterwards.
    ("monte_carlo", |_| Ok(AnyAlgorithm::MonteCarlo { max_episode_steps: 0 })),
    ("monte_carlo_es", |_| Ok(AnyAlgorithm::MonteCarloEs { max_episode_steps: 0 })),
    ("off_policy_monte_carlo", |_| {
        Ok(AnyAlgorithm::OffPolicyMonteCarlo { max_episode_steps: 0, learning_rate: 1.0, min_learning_rate: 0.0 })
    }),
    ("n_step_tree_backup", |fields| {
        let (n_steps, target_policy) = (n_steps(fields)?, target_policy(fields)?);
        Ok(AnyAlgorithm::NStepTreeBackup { n_steps, target_policy })
    }),
    ("n_step_q_sigma", |fields| {
        let (n_steps, target_policy) = (n_steps(fields)?, target_policy(fields)?);
        Ok(AnyAlgorithm::NStepQSigma { n_steps, sigma: fields.get("sigma")?, target_policy })
    }),
    ("prioritized_sweeping", |fields| {
        let (planning_steps, priority_threshold) = (fields.get("planning_steps")?, fields.get("priority_threshold")?);
        Ok(AnyAlgorithm::PrioritizedSweeping { planning_steps, priority_threshold })
    }),
    ("differential_sarsa", |fields| {
        Ok(AnyAlgorithm::DifferentialSarsa { reward_learning_rate: fields.get("reward_learning_rate")? })
    }),
    ("differential_q_learning", |fields| {
        Ok(AnyAlgorithm::DifferentialQLearning { reward_learning_rate: fields.get("reward_learning_rate")? })
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

fn n_steps(fields: &Fields<'_>) -> PyResult<usize> {
    match fields.get("n_steps")? {
        0 => Err(invalid(&fields.path("n_steps"), "at least 1", 0)),
        n_steps => Ok(n_steps),
    }
}

fn target_policy(fields: &Fields<'_>) -> PyResult<TargetPolicy> {
    fields.word("target_policy", &[("greedy", TargetPolicy::Greedy), ("behavior", TargetPolicy::Behavior)])
}

/// Parses an algorithm by its name. Monte Carlo methods also need the time limit, and the off-policy one the learning rate.
pub(crate) fn algorithm(
    fields: &Fields<'_>,
    max_episode_steps: u64,
    learning_rate: LearningRateSpec,
) -> PyResult<AnyAlgorithm> {
    Ok(match fields.tagged(ALGORITHMS)? {
        AnyAlgorithm::MonteCarlo { .. } => AnyAlgorithm::MonteCarlo { max_episode_steps },
        AnyAlgorithm::MonteCarloEs { .. } => AnyAlgorithm::MonteCarloEs { max_episode_steps },
        AnyAlgorithm::OffPolicyMonteCarlo { .. } => match learning_rate {
            LearningRateSpec::Visits { value, minimum } => AnyAlgorithm::OffPolicyMonteCarlo {
                max_episode_steps,
                learning_rate: value,
                min_learning_rate: minimum,
            },
            LearningRateSpec::Schedule(_) => {
                return Err(invalid("learning_rate", "'visits' for 'off_policy_monte_carlo'", "a schedule"));
            }
        },
        algorithm => algorithm,
    })
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
