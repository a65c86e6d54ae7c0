//! Training on what has a row for each of its states: tables, blackjack, the example of maximisation bias.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use qtab_core::Env;
use qtab_core::envs::tabular::{MAXIMIZATION_BIAS_STATES, MaximizationBias};
use qtab_core::envs::toy_text::{Blackjack, Taxi};
use qtab_core::features::{Identity, MultiDiscreteIndex};

use crate::learning::Built;
use crate::native::{cold, hot};
use crate::plan::Plan;
use crate::table::Transitions;

/// A table, and how likely a taxi's passenger changes their mind.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Process {
    pub(crate) table: Py<Transitions>,
    pub(crate) fickle: Option<f64>,
}

/// Those of blackjack.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Rules {
    pub(crate) natural: bool,
    pub(crate) sab: bool,
}

/// The example of maximisation bias: B's actions, and the mean and the deviation of its rewards.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Bias {
    actions: usize,
    mean: f64,
    deviation: f64,
}

impl Process {
    pub(crate) fn build(self, py: Python<'_>, plan: &Plan<'_>) -> PyResult<Built> {
        let table = self.table.bind(py).get().0.clone();
        let states = u32::try_from(table.states()).map_err(|_| PyValueError::new_err("P must have fewer states"))?;
        match self.fickle {
            None if table.num_actions() == 4 => hot::<_, _, 4>(table, Identity(states), plan),
            None => hot::<_, _, 6>(table, Identity(states), plan),
            fickle => cold(Taxi { table, fickle }, Identity(states), 1, plan),
        }
    }
}

impl Rules {
    pub(crate) fn build(self, plan: &Plan<'_>) -> PyResult<Built> {
        let Self { natural, sab } = self;
        hot::<_, _, 2>(
            Blackjack { natural, sab },
            MultiDiscreteIndex(Blackjack::OBSERVATION_SHAPE.map(|count| count as u32)),
            plan,
        )
    }
}

impl Bias {
    pub(crate) fn build(self, plan: &Plan<'_>) -> PyResult<Built> {
        let Self { actions, mean, deviation } = self;
        let env = MaximizationBias { actions, mean, deviation };
        cold(env, Identity(MAXIMIZATION_BIAS_STATES), 1, plan)
    }
}
