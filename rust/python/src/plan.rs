//! A run's description as Python hands it over, every default resolved and every value checked there.

use numpy::PyReadonlyArrayDyn;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use qtab_core::Table;
use qtab_core::features::{Axis, Bins, Edges, Grid, Real, Rounding, Tiles};
use qtab_core::learners::{Agent, Behaviour, EpsilonGreedy, Rate, Schedule, TerminalUpdate, Ties, Trace, Traces};
use qtab_core::random::{Draw, Pcg64, Stream};

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

/// How observations become rows.
#[derive(FromPyObject)]
pub(crate) enum Discretizer {
    #[pyo3(from_item_all)]
    Rounding { scale: Vec<f64> },
    #[pyo3(from_item_all)]
    Tiles { low: Vec<f64>, high: Vec<f64>, tiles: Vec<u32>, tilings: u32, hashed_rows: Option<u32> },
    #[pyo3(from_item_all)]
    Cells { first: Vec<i64>, counts: Vec<u32>, scalar: bool },
    #[pyo3(from_item_all)]
    Bins { edges: Vec<Vec<f64>> },
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

    pub(crate) fn trace(&self) -> PyResult<Trace> {
        match self.traces.as_deref() {
            Some("accumulating") => Ok(Trace::Accumulating),
            Some("replacing") => Ok(Trace::Replacing),
            Some("clearing") => Ok(Trace::Clearing),
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
    pub(crate) fn stream(&self) -> PyResult<Stream> {
        agent_stream(&self.bit_generator, &self.seed)
    }

    pub(crate) fn environment_stream(&self) -> Pcg64 {
        environment_stream(&self.seed)
    }

    /// The article's grid over two float32 components.
    pub(crate) fn plane(&self, scale: &[f64]) -> PyResult<Rounding<f32, [Axis<f32>; 2]>> {
        <[Axis<f32>; 2]>::try_from(self.axes(scale, |bound| bound as f32))
            .map(Rounding::new)
            .map_err(|axes| PyValueError::new_err(format!("scale must hold 2 numbers, got {}", axes.len())))
    }

    /// The grid of either kind, in the dtype of the bounds.
    pub(crate) fn grid<T: Real>(&self, dtype: impl Fn(f64) -> T) -> PyResult<Grid<T>> {
        match &self.features {
            Discretizer::Rounding { scale } => Ok(Grid::Rounding(Rounding::new(self.axes(scale, dtype)))),
            Discretizer::Bins { edges } => Ok(Grid::Bins(Bins::new(self.axes_of(edges)?))),
            Discretizer::Tiles { .. } | Discretizer::Cells { .. } => Err(unknown("discretizer", "identity")),
        }
    }

    /// The axes of the article's grid.
    fn axes<T: Real>(&self, scale: &[f64], dtype: impl Fn(f64) -> T) -> Vec<Axis<T>> {
        let bounds = self.low.iter().zip(&self.high);
        bounds.zip(scale).map(|((&low, &high), &scale)| Axis::new(dtype(low), dtype(high), scale)).collect()
    }

    /// Bins over `N` float32 components.
    pub(crate) fn bins<const N: usize>(&self, edges: &[Vec<f64>]) -> PyResult<Bins<f32, [Edges; N]>> {
        self.axes_of(edges)?.try_into().map(Bins::new).map_err(|_| miscounted(N, edges))
    }

    fn axes_of(&self, edges: &[Vec<f64>]) -> PyResult<Vec<Edges>> {
        if edges.len() != self.low.len() {
            return Err(miscounted(self.low.len(), edges));
        }
        let rising = |edges: &&Vec<f64>| edges.is_sorted() && !edges.iter().any(|edge| edge.is_nan());
        let checked = |edges: &Vec<f64>| match Some(edges).filter(rising) {
            Some(edges) => Ok(Edges::new(edges.clone())),
            None => Err(PyValueError::new_err(format!("edges must rise, got {edges:?}"))),
        };
        edges.iter().map(checked).collect()
    }

    /// What the article's learner is made of, if the plan asks for its kind: an exploration rate that falls linearly from
    /// the first episode on, a learning rate that does not look at the visits.
    pub(crate) fn article<const N: usize>(
        &self,
        rows: usize,
        draw: &mut Pcg64,
    ) -> PyResult<Option<Agent<N, EpsilonGreedy, Schedule>>> {
        let Choice::EpsilonGreedy { epsilon, ties } = &self.policy else { return Ok(None) };
        let plain = ["q_learning", "sarsa", "expected_sarsa"].contains(&self.algorithm.name.as_str())
            && (epsilon.schedule.as_str(), epsilon.warm_up, ties.as_str()) == ("linear", 0, "first")
            && self.learning_rate.schedule != "visits"
            && self.on_truncation == "bootstrap";
        if !plain {
            return Ok(None);
        }
        Ok(Some(Agent {
            table: self.table((0, 1), rows, draw)?,
            policy: EpsilonGreedy::linear(epsilon.value, epsilon.least, self.episodes),
            learning_rate: self.learning_rate.schedule(self.episodes)?,
            discount: self.discount,
            terminal_update: self.terminal_update()?,
        }))
    }

    /// What any learner is made of: the first of so many `tables`; an observation lights `lit` rows.
    pub(crate) fn agent(&self, tables: usize, rows: usize, lit: usize, draw: &mut Stream) -> PyResult<Agent> {
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
        draw: &mut impl Draw,
    ) -> PyResult<Table<N>> {
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
        Ok(Table::new(values, self.actions))
    }

    fn policy(&self) -> PyResult<Behaviour> {
        match &self.policy {
            Choice::EpsilonGreedy { epsilon, ties } => Ok(Behaviour::EpsilonGreedy {
                epsilon: epsilon.schedule(self.episodes)?,
                ties: match ties.as_str() {
                    "first" => Ties::First,
                    "random" => Ties::Random,
                    other => return Err(unknown("ties", other)),
                },
            }),
            Choice::Softmax { temperature } => Ok(Behaviour::softmax(*temperature, self.actions)),
        }
    }

    fn rate(&self, weights: usize, lit: usize) -> PyResult<Rate> {
        let course = &self.learning_rate;
        if course.schedule == "visits" {
            return Ok(Rate::by_visits(course.value, course.least, weights, lit));
        }
        Ok(Rate::scheduled(course.schedule(self.episodes)?, lit))
    }

    fn terminal_update(&self) -> PyResult<TerminalUpdate> {
        match (self.terminal_update.as_str(), &self.features) {
            ("assign", Discretizer::Tiles { .. }) => Err(unknown("terminal_update", "assign")),
            ("assign", _) => Ok(TerminalUpdate::Assign),
            ("target", _) => Ok(TerminalUpdate::Target),
            (other, _) => Err(unknown("terminal_update", other)),
        }
    }

    /// Tile coding.
    pub(crate) fn tiles<T: Real, const M: usize>(&self) -> PyResult<Tiles<T, M>> {
        let Discretizer::Tiles { low, high, tiles, tilings, hashed_rows } = &self.features else {
            return Err(PyValueError::new_err("discretizer must be 'tiles'"));
        };
        if [low.len(), high.len(), tiles.len()].iter().any(|&length| length != self.low.len()) {
            return Err(PyValueError::new_err(format!("tiles must hold {} numbers", self.low.len())));
        }
        let tiles = Tiles::new(low, high, tiles, *tilings);
        Ok(match *hashed_rows {
            Some(rows) => tiles.hashed(rows),
            None => tiles,
        })
    }
}

fn miscounted(components: usize, edges: &[Vec<f64>]) -> PyErr {
    PyValueError::new_err(format!("edges must hold a row for each of {components} components, got {}", edges.len()))
}

pub(crate) fn unknown(name: &str, value: &str) -> PyErr {
    PyValueError::new_err(format!("{name} must be another here, got {value:?}"))
}
