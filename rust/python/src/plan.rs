//! A run's description as Python hands it over, every default resolved and every value checked there.

use numpy::PyReadonlyArrayDyn;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use qtab_core::Table;
use qtab_core::features::{Axis, Real, Rounding};
use qtab_core::learners::{EpsilonGreedy, QLearning, TerminalUpdate};
use qtab_core::random::{Draw, Pcg64, Stream};

use crate::stream::{agent_stream, environment_stream};

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Plan<'py> {
    pub(crate) low: Vec<f64>,
    pub(crate) high: Vec<f64>,
    /// Whether the bounds are float32.
    pub(crate) single: bool,
    pub(crate) scale: Vec<f64>,
    pub(crate) actions: usize,
    pub(crate) max_episode_steps: Option<u64>,
    pub(crate) seed: Vec<u32>,
    pub(crate) bit_generator: String,
    pub(crate) initial_q: InitialQ<'py>,
    pub(crate) learning_rate: f64,
    pub(crate) discount: f64,
    pub(crate) epsilon: f64,
    pub(crate) min_epsilon: f64,
    pub(crate) episodes: u64,
    pub(crate) terminal_update: String,
    /// How many of the last episodes to keep for playing again.
    pub(crate) record: usize,
}

#[derive(FromPyObject)]
pub(crate) enum InitialQ<'py> {
    Table(PyReadonlyArrayDyn<'py, f64>),
    Range((f64, f64)),
}

impl Plan<'_> {
    pub(crate) fn stream(&self) -> PyResult<Stream> {
        agent_stream(&self.bit_generator, &self.seed)
    }

    pub(crate) fn environment_stream(&self) -> Pcg64 {
        environment_stream(&self.seed)
    }

    /// The grid over two float32 components.
    pub(crate) fn plane(&self) -> PyResult<Rounding<f32, [Axis<f32>; 2]>> {
        <[Axis<f32>; 2]>::try_from(self.axes(|bound| bound as f32))
            .map(Rounding::new)
            .map_err(|axes| PyValueError::new_err(format!("scale must hold 2 numbers, got {}", axes.len())))
    }

    pub(crate) fn axes<T: Real>(&self, dtype: impl Fn(f64) -> T) -> Vec<Axis<T>> {
        let bounds = self.low.iter().zip(&self.high);
        bounds.zip(&self.scale).map(|((&low, &high), &scale)| Axis::new(dtype(low), dtype(high), scale)).collect()
    }

    pub(crate) fn q_learning<const N: usize>(&self, rows: usize, draw: &mut impl Draw) -> PyResult<QLearning<N>> {
        let table = match &self.initial_q {
            InitialQ::Table(values) => Table::new(values.as_array().iter().copied().collect(), self.actions),
            InitialQ::Range((low, high)) => Table::uniform(rows, self.actions, *low, *high, draw),
        };
        if table.values().len() != rows * self.actions {
            return Err(PyValueError::new_err(format!("initial_q must hold {rows} rows")));
        }
        Ok(QLearning {
            table,
            policy: EpsilonGreedy::linear(self.epsilon, self.min_epsilon, self.episodes),
            learning_rate: self.learning_rate,
            discount: self.discount,
            terminal_update: match self.terminal_update.as_str() {
                "assign" => TerminalUpdate::Assign,
                "target" => TerminalUpdate::Target,
                other => {
                    let message = format!("terminal_update must be 'assign' or 'target', got {other:?}");
                    return Err(PyValueError::new_err(message));
                }
            },
        })
    }
}
