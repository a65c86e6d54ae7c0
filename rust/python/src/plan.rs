//! A run's description as Python hands it over, every default resolved and every value checked there.

use numpy::PyReadonlyArrayDyn;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use qtab_core::QTable;
use qtab_core::learners::{Agent, TraceKind, Traces};
use qtab_core::policies::{AnyPolicy, EpsilonGreedy, TieBreaking};
use qtab_core::q_table::TerminalUpdate;
use qtab_core::random::{AgentRng, Pcg64, Rng};
use qtab_core::schedules::{LearningRate, Schedule};

use crate::discretizer::Discretizer;
use crate::stream::{agent_stream, environment_stream};

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Plan<'py> {
    pub(crate) low: Vec<f64>,
    pub(crate) high: Vec<f64>,
    /// Whether the bounds are float32.
    pub(crate) single: bool,
    pub(crate) features: Discretizer,
    pub(crate) actions: usize,
    pub(crate) max_episode_steps: Option<u64>,
    pub(crate) seed: Vec<u32>,
    pub(crate) bit_generator: String,
    pub(crate) initial_q: InitialQ<'py>,
    pub(crate) learning_rate: Course,
    pub(crate) discount: f64,
    pub(crate) policy: Choice,
    pub(crate) episodes: u64,
    pub(crate) terminal_update: String,
    pub(crate) on_truncation: String,
    pub(crate) algorithm: Algorithm,
    /// How many of the last episodes to keep for playing again.
    pub(crate) record: usize,
}

#[derive(FromPyObject)]
pub(crate) enum InitialQ<'py> {
    Table(PyReadonlyArrayDyn<'py, f64>),
    Range((f64, f64)),
    Constant(f64),
}

/// A rate from episode to episode.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Course {
    schedule: String,
    value: f64,
    least: f64,
    decay: f64,
    warm_up: u64,
}

/// How actions are chosen.
#[derive(FromPyObject)]
pub(crate) enum Choice {
    #[pyo3(from_item_all)]
    EpsilonGreedy { epsilon: Course, ties: String },
    #[pyo3(from_item_all)]
    Softmax { temperature: f64 },
}

/// A learner by its name, with the options that belong to it; the others are None.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Algorithm {
    pub(crate) name: String,
    pub(crate) trace_decay: Option<f64>,
    pub(crate) traces: Option<String>,
    pub(crate) trace_cutoff: Option<f64>,
    pub(crate) n_steps: Option<usize>,
    pub(crate) planning_steps: Option<u32>,
    pub(crate) time_weight: Option<f64>,
}

impl Algorithm {
    /// No trace alive yet, of the agent's weights.
    pub(crate) fn no_traces(&self, agent: &Agent) -> PyResult<Traces> {
        Ok(Traces::new(agent.table.values().len(), given("trace_cutoff", self.trace_cutoff)?))
    }

    pub(crate) fn trace(&self) -> PyResult<TraceKind> {
        match self.traces.as_deref() {
            Some("accumulating") => Ok(TraceKind::Accumulating),
            Some("replacing") => Ok(TraceKind::Replacing),
            Some("clearing") => Ok(TraceKind::Clearing),
            other => Err(unknown("traces", other.unwrap_or_default())),
        }
    }
}

/// An option that belongs to the algorithm.
pub(crate) fn given<T>(name: &str, option: Option<T>) -> PyResult<T> {
    option.ok_or_else(|| PyValueError::new_err(format!("{name} must be given")))
}

impl Course {
    pub(crate) fn is_constant(&self) -> bool {
        self.schedule == "constant"
    }

    fn schedule(&self, episodes: u64) -> PyResult<Schedule> {
        match self.schedule.as_str() {
            "constant" => Ok(Schedule::constant(self.value)),
            "linear" if self.warm_up < episodes => Ok(Schedule::linear(self.value, self.least, episodes, self.warm_up)),
            "exponential" => Ok(Schedule::exponential(self.value, self.least, self.decay, self.warm_up)),
            other => Err(unknown("schedule", other)),
        }
    }
}

impl Plan<'_> {
    pub(crate) fn stream(&self) -> PyResult<AgentRng> {
        agent_stream(&self.bit_generator, &self.seed)
    }

    pub(crate) fn environment_stream(&self) -> Pcg64 {
        environment_stream(&self.seed)
    }

    /// What the article's learner is made of, if the plan asks for its kind: an exploration rate that falls linearly from
    /// the first episode on, a learning rate that does not look at the visits.
    pub(crate) fn article<const N: usize>(
        &self,
        rows: usize,
        draw: &mut Pcg64,
    ) -> PyResult<Option<Agent<N, EpsilonGreedy, Schedule>>> {
        let Choice::EpsilonGreedy { epsilon, ties } = &self.policy else { return Ok(None) };
        let linear = (epsilon.schedule.as_str(), epsilon.warm_up, ties.as_str()) == ("linear", 0, "first");
        if !linear || self.some_missing() {
            return Ok(None);
        }
        self.plain(EpsilonGreedy::linear(epsilon.value, epsilon.least, self.episodes), rows, draw)
    }

    /// The same with any policy: a one-step learner of a single table whose learning rate does not look at the visits.
    pub(crate) fn plain<const N: usize, P>(
        &self,
        policy: P,
        rows: usize,
        draw: &mut Pcg64,
    ) -> PyResult<Option<Agent<N, P, Schedule>>> {
        let plain = ["q_learning", "sarsa", "expected_sarsa"].contains(&self.algorithm.name.as_str())
            && self.learning_rate.schedule != "visits"
            && self.on_truncation == "bootstrap";
        if !plain {
            return Ok(None);
        }
        Ok(Some(Agent {
            table: self.table((0, 1), rows, draw)?,
            policy,
            learning_rate: self.learning_rate.schedule(self.episodes)?,
            discount: self.discount,
            terminal_update: self.terminal_update()?,
        }))
    }

    /// What any learner is made of: the first of so many `tables`; an observation lights `lit` rows.
    pub(crate) fn agent(&self, tables: usize, rows: usize, lit: usize, draw: &mut AgentRng) -> PyResult<Agent> {
        Ok(Agent {
            table: self.table((0, tables), rows, draw)?,
            policy: self.policy()?,
            learning_rate: self.rate(rows * self.actions, lit)?,
            discount: self.discount,
            terminal_update: self.terminal_update()?,
        })
    }

    /// The table of that index among so many, as it is before the first episode.
    pub(crate) fn table<const N: usize>(
        &self,
        (index, tables): (usize, usize),
        rows: usize,
        draw: &mut impl Rng,
    ) -> PyResult<QTable<N>> {
        let size = rows * self.actions;
        let values = match &self.initial_q {
            InitialQ::Table(values) => {
                let values = values.as_array();
                if values.len() != tables * size {
                    return Err(PyValueError::new_err(format!("initial_q must hold {tables} tables of {rows} rows")));
                }
                values.iter().skip(index * size).take(size).copied().collect()
            }
            InitialQ::Constant(value) => vec![*value; size],
            InitialQ::Range((low, high)) => (0..size).map(|_| draw.uniform(*low, *high)).collect(),
        };
        Ok(QTable::new(values, self.actions))
    }

    pub(crate) fn policy(&self) -> PyResult<AnyPolicy> {
        match &self.policy {
            Choice::EpsilonGreedy { epsilon, ties } => {
                let epsilon = epsilon.schedule(self.episodes)?;
                let ties = match ties.as_str() {
                    "first" => TieBreaking::First,
                    "random" => TieBreaking::Random,
                    other => return Err(unknown("ties", other)),
                };
                Ok(if self.some_missing() {
                    AnyPolicy::MaskedEpsilonGreedy { epsilon, ties }
                } else {
                    AnyPolicy::EpsilonGreedy { epsilon, ties }
                })
            }
            Choice::Softmax { temperature } => Ok(AnyPolicy::softmax(*temperature, self.actions)),
        }
    }

    /// Whether states lack actions: their first values are -∞.
    fn some_missing(&self) -> bool {
        matches!(&self.initial_q, InitialQ::Table(values) if values.as_array().iter().any(|&q| q == f64::NEG_INFINITY))
    }

    fn rate(&self, weights: usize, lit: usize) -> PyResult<LearningRate> {
        let course = &self.learning_rate;
        if course.schedule == "visits" {
            return Ok(LearningRate::by_visit_count(course.value, course.least, weights, lit));
        }
        Ok(LearningRate::scheduled(course.schedule(self.episodes)?, lit))
    }

    fn terminal_update(&self) -> PyResult<TerminalUpdate> {
        match (self.terminal_update.as_str(), &self.features) {
            ("assign", Discretizer::Tiles { .. }) => Err(unknown("terminal_update", "assign")),
            ("assign", _) => Ok(TerminalUpdate::Assign),
            ("target", _) => Ok(TerminalUpdate::Target),
            (other, _) => Err(unknown("terminal_update", other)),
        }
    }
}

pub(crate) fn unknown(name: &str, value: &str) -> PyErr {
    PyValueError::new_err(format!("{name} must be another here, got {value:?}"))
}
