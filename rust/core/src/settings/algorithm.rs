//! The algorithm of a learner, with its options.

use std::marker::PhantomData;

use super::{LearningRateSpec, SettingSource};
use crate::learners::{AnyAlgorithm, TargetPolicy, TraceKind, TraceOptions};

/// Reads the options of an algorithm.
type Reader<S> = fn(&S) -> Result<AnyAlgorithm, <S as SettingSource>::Error>;

/// Every algorithm by its name, with the function that reads its options from settings `S`.
pub struct AlgorithmRows<S>(PhantomData<S>);

impl<S: SettingSource> AlgorithmRows<S> {
    /// The rows. `qtab.config` lists the same names; a test compares the two lists.
    pub const ROWS: [(&'static str, Reader<S>); 23] = [
        ("q_learning", |_| Ok(AnyAlgorithm::QLearning)),
        ("sarsa", |_| Ok(AnyAlgorithm::Sarsa)),
        ("expected_sarsa", |_| Ok(AnyAlgorithm::ExpectedSarsa)),
        ("double_q_learning", |_| Ok(AnyAlgorithm::DoubleQLearning)),
        ("n_step_sarsa", |settings| Ok(AnyAlgorithm::NStepSarsa { n_steps: n_steps(settings)? })),
        ("sarsa_lambda", |settings| traces(settings).map(AnyAlgorithm::SarsaLambda)),
        ("true_online_sarsa_lambda", |settings| {
            let (trace_decay, trace_cutoff) = (number(settings, "trace_decay")?, number(settings, "trace_cutoff")?);
            Ok(AnyAlgorithm::TrueOnlineSarsaLambda { trace_decay, trace_cutoff })
        }),
        ("watkins_q_lambda", |settings| traces(settings).map(AnyAlgorithm::WatkinsQLambda)),
        ("dyna_q", |settings| {
            let planning_steps = planning_steps(settings)?;
            // The playground has only the deterministic model, and omits the setting.
            let models = [("deterministic", false), ("stochastic", true)];
            Ok(if settings.has("model") && settings.word("model", &models)? {
                AnyAlgorithm::StochasticDynaQ { planning_steps }
            } else {
                AnyAlgorithm::DynaQ { planning_steps }
            })
        }),
        ("dyna_q_plus", |settings| {
            let (planning_steps, time_weight) = (planning_steps(settings)?, number(settings, "time_weight")?);
            Ok(AnyAlgorithm::DynaQPlus { planning_steps, time_weight })
        }),
        // The other settings of a run that some of these need are filled in afterwards.
        ("monte_carlo", |_| Ok(AnyAlgorithm::MonteCarlo { max_episode_steps: 0 })),
        ("monte_carlo_es", |_| Ok(AnyAlgorithm::MonteCarloEs { max_episode_steps: 0 })),
        ("off_policy_monte_carlo", |_| {
            Ok(AnyAlgorithm::OffPolicyMonteCarlo { max_episode_steps: 0, learning_rate: 1.0, min_learning_rate: 0.0 })
        }),
        ("n_step_tree_backup", |settings| {
            let (n_steps, target_policy) = (n_steps(settings)?, target_policy(settings)?);
            Ok(AnyAlgorithm::NStepTreeBackup { n_steps, target_policy })
        }),
        ("n_step_q_sigma", |settings| {
            let (n_steps, target_policy) = (n_steps(settings)?, target_policy(settings)?);
            Ok(AnyAlgorithm::NStepQSigma { n_steps, sigma: number(settings, "sigma")?, target_policy })
        }),
        ("prioritized_sweeping", |settings| {
            let priority_threshold = number(settings, "priority_threshold")?;
            Ok(AnyAlgorithm::PrioritizedSweeping { planning_steps: planning_steps(settings)?, priority_threshold })
        }),
        ("differential_sarsa", |settings| {
            Ok(AnyAlgorithm::DifferentialSarsa { reward_learning_rate: number(settings, "reward_learning_rate")? })
        }),
        ("differential_q_learning", |settings| {
            Ok(AnyAlgorithm::DifferentialQLearning { reward_learning_rate: number(settings, "reward_learning_rate")? })
        }),
        ("gradient_bandit", |settings| Ok(AnyAlgorithm::GradientBandit { baseline: settings.flag("baseline")? })),
        ("reinforce", |_| Ok(AnyAlgorithm::Reinforce)),
        ("reinforce_with_baseline", |settings| {
            Ok(AnyAlgorithm::ReinforceWithBaseline { value_learning_rate: number(settings, "value_learning_rate")? })
        }),
        ("actor_critic", |settings| {
            Ok(AnyAlgorithm::ActorCritic { value_learning_rate: number(settings, "value_learning_rate")? })
        }),
        ("actor_critic_lambda", |settings| {
            let (value_learning_rate, trace_decay) =
                (number(settings, "value_learning_rate")?, number(settings, "trace_decay")?);
            Ok(AnyAlgorithm::ActorCriticLambda { value_learning_rate, trace_decay })
        }),
    ];
}

impl AnyAlgorithm {
    /// The algorithm that the settings name, with its options and its learning rate, for a run of `episodes` episodes.
    ///
    /// The learning rate is at most `largest_rate`, except for preferences, which have no limit. Monte Carlo methods
    /// also need the time limit, and the off-policy one the learning rate.
    ///
    /// # Errors
    /// If a setting is missing or invalid.
    pub fn parse<S: SettingSource>(
        settings: &S,
        episodes: u64,
        max_episode_steps: u64,
        largest_rate: f64,
    ) -> Result<(Self, LearningRateSpec), S::Error> {
        let algorithm = settings.word("algorithm", &AlgorithmRows::ROWS)?(settings)?;
        let largest_rate = if algorithm.learns_preferences() { f64::MAX } else { largest_rate };
        let learning_rate = LearningRateSpec::parse(settings, largest_rate, episodes)?;
        let algorithm = match (algorithm, learning_rate) {
            (Self::OffPolicyMonteCarlo { .. }, LearningRateSpec::Visits { value, minimum }) => {
                Self::OffPolicyMonteCarlo { max_episode_steps, learning_rate: value, min_learning_rate: minimum }
            }
            (Self::OffPolicyMonteCarlo { .. }, LearningRateSpec::Schedule(_)) => {
                return Err(settings.invalid("learning_rate_schedule", "'visits' for 'off_policy_monte_carlo'"));
            }
            (algorithm, _) => algorithm.with_time_limit(max_episode_steps),
        };
        Ok((algorithm, learning_rate))
    }
}

/// The smallest and the largest value of an option of an algorithm.
pub(crate) fn range_of(option: &str) -> (f64, f64) {
    match option {
        "time_weight" | "priority_threshold" => (0.0, f64::MAX),
        // Tile coding divides it among the tilings.
        "value_learning_rate" => (0.0, 2.0),
        _ => (0.0, 1.0),
    }
}

fn number<S: SettingSource>(settings: &S, option: &'static str) -> Result<f64, S::Error> {
    let (low, high) = range_of(option);
    settings.number(option, low, high)
}

fn n_steps<S: SettingSource>(settings: &S) -> Result<usize, S::Error> {
    settings.integer("n_steps", 1, 1_000_000).map(|n_steps| n_steps as usize)
}

fn planning_steps<S: SettingSource>(settings: &S) -> Result<u32, S::Error> {
    settings.integer("planning_steps", 0, 1_000_000).map(|steps| steps as u32)
}

fn target_policy<S: SettingSource>(settings: &S) -> Result<TargetPolicy, S::Error> {
    settings.word("target_policy", &[("greedy", TargetPolicy::Greedy), ("behavior", TargetPolicy::Behavior)])
}

fn traces<S: SettingSource>(settings: &S) -> Result<TraceOptions, S::Error> {
    let kinds = [
        ("accumulating", TraceKind::Accumulating),
        ("replacing", TraceKind::Replacing),
        ("clearing", TraceKind::Clearing),
    ];
    let kind = settings.word("traces", &kinds)?;
    Ok(TraceOptions { kind, decay: number(settings, "trace_decay")?, cutoff: number(settings, "trace_cutoff")? })
}
