//! The settings of a run, by their names in `qtab.Config`: all that apply, and no others.

mod discretizer;
mod fields;

use qtab_core::learners::{Agent, AnyAlgorithm, FeatureKinds};
use qtab_core::memory::{AllocationError, filled, from_fn};
use qtab_core::q_table::TerminalUpdate;
use qtab_core::random::{AgentRng, Rng, SeedSequence};
use qtab_core::settings::{LearningRateSpec, PolicySpec, SettingSource as _};
use qtab_core::{QTable, StopFlag};
use serde_json::Value;

pub(crate) use discretizer::{Discretizer, MAX_FEATURES};
use fields::Fields;

use crate::environment::Bounds;
use crate::failure::Failure;
use crate::json::numbers;

const MAX_EPISODES: u64 = 1_000_000;
const MAX_STEPS: u64 = 1_000_000;

/// A run without its environment and its seed.
#[derive(Clone, Debug)]
pub(crate) struct Settings {
    pub(crate) algorithm: AnyAlgorithm,
    policy: PolicySpec,
    pub(crate) learning_rate: LearningRateSpec,
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
enum InitialQ {
    Uniform { low: f64, high: f64 },
    Constant(f64),
}

impl Settings {
    /// `bounds` are those of the observation space; `None` for numbered states.
    pub(crate) fn parse(settings: &Value, bounds: Option<Bounds>) -> Result<Self, Failure> {
        let fields = Fields::new(settings)?;
        let episodes = fields.integer("episodes", 1, MAX_EPISODES)?;
        let max_episode_steps = fields.integer("max_episode_steps", 1, MAX_STEPS)?;
        let discretizer = Discretizer::parse(&fields, bounds)?;
        let weighted = discretizer.is_weighted();
        let has_cells = discretizer.limits().is_none();
        let largest_rate = if has_cells { 1.0 } else { 2.0 };
        fields.word("algorithm", ALGORITHMS)?;
        fields.word("exploration", &[("epsilon_greedy", ()), ("softmax", ())])?;
        if fields.has("model") {
            fields.word("model", &[("deterministic", ())])?;
        }
        let (algorithm, learning_rate) = AnyAlgorithm::parse(&fields, episodes, max_episode_steps, largest_rate)?;
        if weighted {
            match algorithm.feature_kinds() {
                FeatureKinds::All => {}
                FeatureKinds::Binary => {
                    return Err(fields.invalid("traces", "'accumulating' for discretizer 'fourier'"));
                }
                FeatureKinds::SingleRows => {
                    let expected = "one that learns with weighted features for discretizer 'fourier'";
                    return Err(fields.invalid("algorithm", expected));
                }
            }
        }
        if !has_cells && algorithm.needs_single_rows() {
            return Err(fields.invalid("algorithm", "an algorithm without a model for discretizer 'tiles'"));
        }
        let terminal_update = fields.word("terminal_update", TERMINAL_UPDATES)?;
        if terminal_update == TerminalUpdate::Assign && !(has_cells && assigns(algorithm)) {
            return Err(fields.invalid("terminal_update", "'target' for this algorithm and discretizer"));
        }
        let parsed = Self {
            algorithm,
            policy: PolicySpec::parse(&fields, episodes)?,
            learning_rate,
            discount: fields.number("discount", 0.0, 1.0)?,
            initial_q: initial_q(&fields)?,
            terminal_update,
            terminate_on_truncation: fields.word("on_truncation", &[("bootstrap", false), ("terminate", true)])?,
            discretizer,
            episodes: episodes as usize,
            max_episode_steps,
            mersenne_twister: fields.word("bit_generator", &[("PCG64", false), ("MT19937", true)])?,
        };
        let visits = matches!(parsed.learning_rate, LearningRateSpec::Visits { .. });
        if visits && (weighted || matches!(parsed.algorithm, AnyAlgorithm::TrueOnlineSarsaLambda { .. })) {
            let chosen = if weighted { "discretizer" } else { "algorithm" };
            let expected = format!("'constant', 'linear' or 'exponential' for this {chosen}");
            return Err(fields.invalid("learning_rate_schedule", &expected));
        }
        fields.check_all_used()?;
        Ok(parsed)
    }

    /// The agent's generator of a run, before its first draw.
    pub(crate) fn rng(&self, seed: u32) -> AgentRng {
        if self.mersenne_twister { AgentRng::mt19937(seed) } else { AgentRng::pcg64(&SeedSequence::new(&[seed])) }
    }

    /// The agent before its first episode, and the second table if the algorithm learns two.
    pub(crate) fn agent(
        &self,
        (n_rows, num_actions): (usize, usize),
        rng: &mut AgentRng,
    ) -> Result<(Agent, Option<QTable>), AllocationError> {
        let (stop, weights) = (StopFlag::new(), n_rows * num_actions);
        let table = self.table(weights, num_actions, rng)?;
        let second = (self.algorithm.n_tables() == 2).then(|| self.table(weights, num_actions, rng)).transpose()?;
        let episodes = self.episodes as u64;
        let of_weighted = || self.learning_rate.build_weighted(episodes, self.discretizer.step_size_divisors()?);
        let learning_rate = match of_weighted() {
            Some(learning_rate) => learning_rate,
            None => self.learning_rate.build(episodes, weights, self.discretizer.n_active(), &stop)?,
        };
        let policy = self.policy.build(episodes, (n_rows, num_actions), false, &stop)?;
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

/// The algorithms whose learners the playground has.
const ALGORITHMS: &[(&str, ())] = &[
    ("q_learning", ()),
    ("sarsa", ()),
    ("expected_sarsa", ()),
    ("double_q_learning", ()),
    ("n_step_sarsa", ()),
    ("sarsa_lambda", ()),
    ("true_online_sarsa_lambda", ()),
    ("watkins_q_lambda", ()),
    ("dyna_q", ()),
    ("dyna_q_plus", ()),
];

const TERMINAL_UPDATES: &[(&str, TerminalUpdate)] =
    &[("target", TerminalUpdate::Target), ("assign", TerminalUpdate::Assign)];

/// Whether an algorithm can assign a value at a terminal state.
fn assigns(algorithm: AnyAlgorithm) -> bool {
    use AnyAlgorithm::{DoubleQLearning, DynaQ, DynaQPlus, ExpectedSarsa, QLearning, Sarsa};
    matches!(algorithm, QLearning | Sarsa | ExpectedSarsa | DoubleQLearning | DynaQ { .. } | DynaQPlus { .. })
}

fn initial_q(fields: &Fields<'_>) -> Result<InitialQ, Failure> {
    let given = fields.any("initial_q")?;
    if let Some(value) = given.as_f64() {
        return Ok(InitialQ::Constant(value));
    }
    match numbers(given).as_deref() {
        Some(&[low, high]) if low <= high && (high - low).is_finite() => Ok(InitialQ::Uniform { low, high }),
        _ => Err(fields.invalid("initial_q", "a finite number, or a range [low, high] of finite numbers")),
    }
}
