//! The settings of a run, by the names of `qtab.Config`: every one that applies, and no other.

mod discretizer;
mod fields;

use qtab_core::learners::{Agent, AnyAlgorithm, TraceKind, TraceOptions};
use qtab_core::memory::{AllocationError, filled, from_fn};
use qtab_core::policies::{AnyPolicy, TieBreaking};
use qtab_core::q_table::TerminalUpdate;
use qtab_core::random::{AgentRng, Rng, SeedSequence};
use qtab_core::schedules::{LearningRate, Schedule};
use qtab_core::{QTable, StopFlag};
use serde_json::Value;

pub(crate) use discretizer::Discretizer;
use fields::Fields;
pub(crate) use fields::SettingError;

use crate::environment::Bounds;
use crate::json::numbers;

const MAX_EPISODES: u32 = 1_000_000;
const MAX_STEPS: u32 = 1_000_000;

/// All of a run but its environment and its seed.
#[derive(Clone, Debug)]
pub(crate) struct Settings {
    pub(crate) algorithm: AnyAlgorithm,
    policy: PolicySetting,
    pub(crate) learning_rate: LearningRateSetting,
    pub(crate) discount: f64,
    initial_q: InitialQ,
    pub(crate) terminal_update: TerminalUpdate,
    pub(crate) terminate_on_truncation: bool,
    pub(crate) discretizer: Discretizer,
    pub(crate) episodes: usize,
    pub(crate) max_episode_steps: u64,
    mersenne_twister: bool,
}

#[derive(Clone, Copy, Debug)]
enum PolicySetting {
    EpsilonGreedy { epsilon: Schedule, ties: TieBreaking },
    Softmax { temperature: f64 },
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum LearningRateSetting {
    Schedule(Schedule),
    Visits { value: f64, minimum: f64 },
}

#[derive(Clone, Copy, Debug)]
enum InitialQ {
    Uniform { low: f64, high: f64 },
    Constant(f64),
}

impl Settings {
    /// `bounds` are those of the observation space; `None` for numbered states.
    pub(crate) fn parse(settings: &Value, bounds: Option<Bounds>) -> Result<Self, SettingError> {
        let fields = Fields::new(settings)?;
        let episodes = fields.integer("episodes", 1, MAX_EPISODES)?;
        let discretizer = Discretizer::parse(&fields, bounds)?;
        let tiles = matches!(discretizer, Discretizer::Tiles { .. });
        let algorithm = algorithm(&fields)?;
        if tiles && algorithm.needs_single_rows() {
            return Err(fields.invalid("algorithm", "an algorithm without a model for discretizer 'tiles'"));
        }
        let terminal_update = fields.word("terminal_update", TERMINAL_UPDATES)?;
        if terminal_update == TerminalUpdate::Assign && (tiles || !assigns(algorithm)) {
            return Err(fields.invalid("terminal_update", "'target' for this algorithm and discretizer"));
        }
        let parsed = Self {
            algorithm,
            policy: policy(&fields, episodes)?,
            learning_rate: learning_rate(&fields, episodes, if tiles { 2.0 } else { 1.0 })?,
            discount: fields.number("discount", 0.0, 1.0)?,
            initial_q: initial_q(&fields)?,
            terminal_update,
            terminate_on_truncation: fields.word("on_truncation", &[("bootstrap", false), ("terminate", true)])?,
            discretizer,
            episodes: episodes as usize,
            max_episode_steps: fields.integer("max_episode_steps", 1, MAX_STEPS)?.into(),
            mersenne_twister: fields.word("bit_generator", &[("PCG64", false), ("MT19937", true)])?,
        };
        let visits = matches!(parsed.learning_rate, LearningRateSetting::Visits { .. });
        if visits && matches!(parsed.algorithm, AnyAlgorithm::TrueOnlineSarsaLambda { .. }) {
            return Err(
                fields.invalid("learning_rate_schedule", "'constant', 'linear' or 'exponential' for this algorithm")
            );
        }
        fields.check_all_used()?;
        Ok(parsed)
    }

    /// The agent's generator of a run, before its first draw.
    pub(crate) fn rng(&self, seed: u32) -> AgentRng {
        if self.mersenne_twister { AgentRng::mt19937(seed) } else { AgentRng::pcg64(&SeedSequence::new(&[seed])) }
    }

    /// The agent before its first episode, and the second table of an algorithm that learns two.
    pub(crate) fn agent(
        &self,
        (n_rows, num_actions): (usize, usize),
        n_active: usize,
        rng: &mut AgentRng,
    ) -> Result<(Agent, Option<QTable>), AllocationError> {
        let (stop, weights) = (StopFlag::new(), n_rows * num_actions);
        let table = self.table(weights, num_actions, rng)?;
        let second = (self.algorithm.n_tables() == 2).then(|| self.table(weights, num_actions, rng)).transpose()?;
        let learning_rate = match self.learning_rate {
            LearningRateSetting::Schedule(schedule) => LearningRate::scheduled(schedule, n_active),
            LearningRateSetting::Visits { value, minimum } => {
                LearningRate::by_visit_count(value, minimum, weights, n_active, &stop)?
            }
        };
        let policy = match self.policy {
            PolicySetting::EpsilonGreedy { epsilon, ties } => AnyPolicy::EpsilonGreedy { epsilon, ties },
            PolicySetting::Softmax { temperature } => AnyPolicy::softmax(temperature, num_actions),
        };
        let (discount, terminal_update) = (self.discount, self.terminal_update);
        Ok((Agent { table, policy, learning_rate, discount, terminal_update, masks: None }, second))
    }

    fn table(&self, weights: usize, num_actions: usize, rng: &mut AgentRng) -> Result<QTable, AllocationError> {
        let stop = StopFlag::new();
        let values = match self.initial_q {
            InitialQ::Constant(value) => filled(&value, weights, &stop)?,
            InitialQ::Uniform { low, high } => from_fn(weights, &stop, || rng.uniform(low, high))?,
        };
        Ok(QTable::new(values, num_actions))
    }
}

const TERMINAL_UPDATES: &[(&str, TerminalUpdate)] =
    &[("target", TerminalUpdate::Target), ("assign", TerminalUpdate::Assign)];

/// Whether an algorithm can assign a value at a terminal state.
fn assigns(algorithm: AnyAlgorithm) -> bool {
    use AnyAlgorithm::{DoubleQLearning, DynaQ, DynaQPlus, ExpectedSarsa, QLearning, Sarsa};
    matches!(algorithm, QLearning | Sarsa | ExpectedSarsa | DoubleQLearning | DynaQ { .. } | DynaQPlus { .. })
}

type AlgorithmParser = fn(&Fields<'_>) -> Result<AnyAlgorithm, SettingError>;

const ALGORITHMS: &[(&str, AlgorithmParser)] = &[
    ("q_learning", |_| Ok(AnyAlgorithm::QLearning)),
    ("sarsa", |_| Ok(AnyAlgorithm::Sarsa)),
    ("expected_sarsa", |_| Ok(AnyAlgorithm::ExpectedSarsa)),
    ("double_q_learning", |_| Ok(AnyAlgorithm::DoubleQLearning)),
    ("n_step_sarsa", |fields| {
        Ok(AnyAlgorithm::NStepSarsa { n_steps: fields.integer("n_steps", 1, 1_000_000)? as usize })
    }),
    ("sarsa_lambda", |fields| trace_options(fields).map(AnyAlgorithm::SarsaLambda)),
    ("true_online_sarsa_lambda", |fields| {
        let trace_decay = fields.number("trace_decay", 0.0, 1.0)?;
        Ok(AnyAlgorithm::TrueOnlineSarsaLambda { trace_decay, trace_cutoff: fields.number("trace_cutoff", 0.0, 1.0)? })
    }),
    ("watkins_q_lambda", |fields| trace_options(fields).map(AnyAlgorithm::WatkinsQLambda)),
    ("dyna_q", |fields| Ok(AnyAlgorithm::DynaQ { planning_steps: fields.integer("planning_steps", 0, 1_000_000)? })),
    ("dyna_q_plus", |fields| {
        let planning_steps = fields.integer("planning_steps", 0, 1_000_000)?;
        Ok(AnyAlgorithm::DynaQPlus { planning_steps, time_weight: fields.number("time_weight", 0.0, f64::MAX)? })
    }),
];

fn algorithm(fields: &Fields<'_>) -> Result<AnyAlgorithm, SettingError> {
    fields.word("algorithm", ALGORITHMS)?(fields)
}

fn trace_options(fields: &Fields<'_>) -> Result<TraceOptions, SettingError> {
    let kinds = [
        ("accumulating", TraceKind::Accumulating),
        ("replacing", TraceKind::Replacing),
        ("clearing", TraceKind::Clearing),
    ];
    let kind = fields.word("traces", &kinds)?;
    let decay = fields.number("trace_decay", 0.0, 1.0)?;
    Ok(TraceOptions { kind, decay, cutoff: fields.number("trace_cutoff", 0.0, 1.0)? })
}

fn policy(fields: &Fields<'_>, episodes: u32) -> Result<PolicySetting, SettingError> {
    if fields.word("exploration", &[("epsilon_greedy", false), ("softmax", true)])? {
        return Ok(PolicySetting::Softmax { temperature: fields.number("temperature", f64::MIN_POSITIVE, f64::MAX)? });
    }
    let names = ["epsilon", "min_epsilon", "epsilon_decay", "epsilon_warm_up"];
    let kind = fields.word("epsilon_schedule", &SCHEDULES[..3])?;
    let epsilon = schedule(fields, kind, names, 1.0, episodes)?;
    let ties = fields.word("ties", &[("first", TieBreaking::First), ("random", TieBreaking::Random)])?;
    Ok(PolicySetting::EpsilonGreedy { epsilon, ties })
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum ScheduleKind {
    Constant,
    Linear,
    Exponential,
    Visits,
}

/// The schedules of the learning rate; epsilon has all but the last.
const SCHEDULES: [(&str, ScheduleKind); 4] = [
    ("constant", ScheduleKind::Constant),
    ("linear", ScheduleKind::Linear),
    ("exponential", ScheduleKind::Exponential),
    ("visits", ScheduleKind::Visits),
];

fn learning_rate(fields: &Fields<'_>, episodes: u32, most: f64) -> Result<LearningRateSetting, SettingError> {
    let names = ["learning_rate", "min_learning_rate", "learning_rate_decay", "learning_rate_warm_up"];
    let kind = fields.word("learning_rate_schedule", &SCHEDULES)?;
    if kind == ScheduleKind::Visits {
        let value = fields.number(names[0], 0.0, most)?;
        return Ok(LearningRateSetting::Visits { value, minimum: fields.number(names[1], 0.0, value)? });
    }
    schedule(fields, kind, names, most, episodes).map(LearningRateSetting::Schedule)
}

/// A schedule by the episode, of the settings with these names: the value, the minimum, the decay, the warm-up.
fn schedule(
    fields: &Fields<'_>,
    kind: ScheduleKind,
    [value, minimum, decay, warm_up]: [&'static str; 4],
    most: f64,
    episodes: u32,
) -> Result<Schedule, SettingError> {
    let value = fields.number(value, 0.0, most)?;
    if kind == ScheduleKind::Constant {
        return Ok(Schedule::constant(value));
    }
    let minimum = fields.number(minimum, 0.0, value)?;
    let warm_up = u64::from(fields.integer(warm_up, 0, episodes - 1)?);
    if kind == ScheduleKind::Linear {
        return Ok(Schedule::linear(value, minimum, episodes.into(), warm_up));
    }
    Ok(Schedule::exponential(value, minimum, fields.number(decay, 0.0, 1.0)?, warm_up))
}

fn initial_q(fields: &Fields<'_>) -> Result<InitialQ, SettingError> {
    let given = fields.any("initial_q")?;
    if let Some(value) = given.as_f64() {
        return Ok(InitialQ::Constant(value));
    }
    match numbers(given).as_deref() {
        Some(&[low, high]) if low <= high && (high - low).is_finite() => Ok(InitialQ::Uniform { low, high }),
        _ => Err(fields.invalid("initial_q", "a finite number, or a range [low, high] of finite numbers")),
    }
}
