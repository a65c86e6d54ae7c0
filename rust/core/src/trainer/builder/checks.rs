//! The checks of a run's settings, alone and together.

use super::{InitialValues, TrainerBuilder};
use crate::errors::BuildError;
use crate::learners::{AnyAlgorithm, FeatureKinds, TraceOptions};
use crate::q_table::TerminalUpdate;
use crate::settings::{LearningRateSpec, PolicySpec, ScheduleSpec, range_of};

/// The numbers of rows, of actions, and of rows that are active at a time.
#[derive(Clone, Copy)]
pub(super) struct Shape {
    pub(super) rows: usize,
    pub(super) actions: usize,
    pub(super) n_active: usize,
    /// Whether the features are weighted.
    pub(super) weighted: bool,
}

impl Shape {
    /// Whether each state has a row of its own, as on a grid.
    fn has_cells(&self) -> bool {
        self.n_active <= 1 && !self.weighted
    }
}

impl<E, F> TrainerBuilder<E, F> {
    /// Checks everything but the environment and the features.
    pub(super) fn check(&self, shape: Shape) -> Result<(), BuildError> {
        BuildError::check_number("discount", 0.0, 1.0, self.discount)?;
        BuildError::check(self.max_episode_steps != Some(0), "max_episode_steps", "at least 1", 0)?;
        let fits = self.terminal_update == TerminalUpdate::Target || shape.has_cells();
        let got = format_args!("Assign with {} active rows", shape.n_active);
        BuildError::check(fits, "terminal_update", "Target with several active rows", got)?;
        self.check_initial_values(shape)?;
        self.check_learning_rate(shape)?;
        self.check_policy(shape)?;
        self.check_algorithm(shape)
    }

    fn check_initial_values(&self, shape: Shape) -> Result<(), BuildError> {
        match &self.initial_values {
            InitialValues::Constant(value) => {
                BuildError::check(value.is_finite(), "initial_value", "a finite number", value)
            }
            &InitialValues::Uniform { low, high } => {
                let in_order = low.is_finite() && high.is_finite() && low <= high;
                let got = format_args!("{low} and {high}");
                BuildError::check(in_order, "initial_uniform", "finite bounds in order", got)
            }
            InitialValues::Table(table) => {
                let (rows, actions) = table.shape();
                let expected = format_args!(
                    "one of {} rows and {} actions, as the features and the environment have",
                    shape.rows, shape.actions
                );
                let got = format_args!("{rows} rows and {actions} actions");
                BuildError::check((rows, actions) == (shape.rows, shape.actions), "initial_table", expected, got)?;
                let is_finite = table.values().iter().all(|value| value.is_finite());
                BuildError::check(is_finite, "initial_table", "a table of finite values", "NaN or infinity")
            }
        }
    }

    fn check_learning_rate(&self, shape: Shape) -> Result<(), BuildError> {
        let most = match shape.has_cells() {
            _ if self.algorithm.learns_preferences() => f64::MAX,
            true => 1.0,
            false => 2.0,
        };
        match &self.learning_rate {
            LearningRateSpec::Schedule(schedule) => self.check_schedule("learning_rate", schedule, most),
            &LearningRateSpec::Visits { value, minimum } => {
                let fits = self.algorithm.takes_rates_by_visits();
                BuildError::check(fits, "learning_rate", "a schedule for this algorithm", "one by visits")?;
                BuildError::check_number("learning_rate", 0.0, most, value)?;
                BuildError::check_number("the minimum of learning_rate", 0.0, value, minimum)
            }
        }
    }

    fn check_schedule(&self, setting: &'static str, schedule: &ScheduleSpec, most: f64) -> Result<(), BuildError> {
        let check_minimum = |minimum, value| {
            let expected = format_args!("a schedule whose minimum is in [0, {value}]");
            BuildError::check((0.0..=value).contains(&minimum), setting, expected, minimum)
        };
        match *schedule {
            ScheduleSpec::Constant { value } => BuildError::check_number(setting, 0.0, most, value),
            ScheduleSpec::Exponential { value, minimum, decay, .. } => {
                BuildError::check_number(setting, 0.0, most, value)?;
                check_minimum(minimum, value)?;
                let is_share = (0.0..=1.0).contains(&decay);
                BuildError::check(is_share, setting, "a schedule whose decay is in [0, 1]", decay)
            }
            ScheduleSpec::Linear { value, minimum, warm_up } => {
                BuildError::check_number(setting, 0.0, most, value)?;
                check_minimum(minimum, value)?;
                let Some(episodes) = self.episodes else {
                    let expected = format_args!("given, because {setting} falls linearly");
                    return Err(BuildError::invalid("episodes", expected, "none"));
                };
                let expected = format_args!("a schedule whose warm-up is less than the {episodes} episodes");
                BuildError::check(warm_up < episodes, setting, expected, warm_up)
            }
        }
    }

    fn check_policy(&self, shape: Shape) -> Result<(), BuildError> {
        let is_softmax = matches!(self.policy, PolicySpec::Softmax { .. });
        let fits = is_softmax || !self.algorithm.learns_preferences();
        BuildError::check(fits, "policy", "Softmax for an algorithm that learns preferences", name(&self.policy))?;
        match &self.policy {
            PolicySpec::EpsilonGreedy { epsilon, .. } => self.check_schedule("epsilon", epsilon, 1.0),
            &PolicySpec::Softmax { temperature } => {
                let is_valid = temperature > 0.0 && temperature.is_finite();
                BuildError::check(is_valid, "temperature", "a finite number above 0", temperature)
            }
            &PolicySpec::Ucb { confidence, .. } => {
                BuildError::check(shape.has_cells(), "policy", "one without counts for several active rows", "Ucb")?;
                let fits = !self.algorithm.needs_probabilities();
                BuildError::check(fits, "policy", "one with probabilities for this algorithm", "Ucb")?;
                BuildError::check_number("confidence", 0.0, f64::MAX, confidence)
            }
        }
    }

    fn check_algorithm(&self, shape: Shape) -> Result<(), BuildError> {
        let takes_weighted = self.algorithm.feature_kinds() == FeatureKinds::All;
        let expected = "one that learns with weighted features, without replacing traces";
        BuildError::check(
            takes_weighted || !shape.weighted,
            "algorithm",
            expected,
            format_args!("{:?}", self.algorithm),
        )?;
        let fits = shape.n_active <= 1 || !self.algorithm.needs_single_rows();
        let got = format_args!("{} for {:?}", shape.n_active, self.algorithm);
        let expected = "1 for an algorithm that needs single rows";
        BuildError::check(fits, "the number of active rows", expected, got)?;
        let check = |option, number| {
            let (low, high) = range_of(option);
            BuildError::check_number(option, low, high, number)
        };
        match self.algorithm {
            AnyAlgorithm::NStepSarsa { n_steps: 0 }
            | AnyAlgorithm::NStepTreeBackup { n_steps: 0, .. }
            | AnyAlgorithm::NStepQSigma { n_steps: 0, .. } => Err(BuildError::invalid("n_steps", "at least 1", 0)),
            AnyAlgorithm::NStepQSigma { sigma, .. } => check("sigma", sigma),
            AnyAlgorithm::SarsaLambda(TraceOptions { decay, cutoff, .. })
            | AnyAlgorithm::WatkinsQLambda(TraceOptions { decay, cutoff, .. })
            | AnyAlgorithm::TrueOnlineSarsaLambda { trace_decay: decay, trace_cutoff: cutoff } => {
                check("trace_decay", decay)?;
                check("trace_cutoff", cutoff)
            }
            AnyAlgorithm::DynaQPlus { time_weight, .. } => check("time_weight", time_weight),
            AnyAlgorithm::PrioritizedSweeping { priority_threshold, .. } => {
                check("priority_threshold", priority_threshold)
            }
            AnyAlgorithm::DifferentialSarsa { reward_learning_rate }
            | AnyAlgorithm::DifferentialQLearning { reward_learning_rate } => {
                check("reward_learning_rate", reward_learning_rate)
            }
            AnyAlgorithm::ReinforceWithBaseline { value_learning_rate }
            | AnyAlgorithm::ActorCritic { value_learning_rate } => check("value_learning_rate", value_learning_rate),
            AnyAlgorithm::ActorCriticLambda { value_learning_rate, trace_decay } => {
                check("value_learning_rate", value_learning_rate)?;
                check("trace_decay", trace_decay)
            }
            AnyAlgorithm::MonteCarlo { .. } | AnyAlgorithm::MonteCarloEs { .. } => self.check_time_limit(),
            AnyAlgorithm::OffPolicyMonteCarlo { learning_rate, min_learning_rate, .. } => {
                check("learning_rate", learning_rate)?;
                BuildError::check_number("min_learning_rate", 0.0, learning_rate, min_learning_rate)?;
                self.check_time_limit()
            }
            _ => Ok(()),
        }
    }

    fn check_time_limit(&self) -> Result<(), BuildError> {
        let has_limit = self.max_episode_steps.is_some();
        BuildError::check(has_limit, "max_episode_steps", "given for a Monte Carlo method", "none")
    }
}

fn name(policy: &PolicySpec) -> &'static str {
    match policy {
        PolicySpec::EpsilonGreedy { .. } => "EpsilonGreedy",
        PolicySpec::Softmax { .. } => "Softmax",
        PolicySpec::Ucb { .. } => "Ucb",
    }
}
