//! Training on what has a row for each of its states: tables, blackjack, the example of maximisation bias.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use qtab_core::Env;
use qtab_core::envs::{Blackjack, MAXIMIZATION_BIAS_STATES, MaximizationBias, Taxi};
use qtab_core::features::{Cells, Features, Identity};
use qtab_core::random::Stream;
use qtab_core::worlds::Native;

use crate::dispatch::{Built, Kept, boxed, whole};
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
            None if table.actions() == 4 => build::<_, _, 4>(table, Identity(states), plan),
            None => build::<_, _, 6>(table, Identity(states), plan),
            fickle => build::<_, _, 0>(Taxi { table, fickle }, Identity(states), plan),
        }
    }
}

impl Rules {
    pub(crate) fn build(self, plan: &Plan<'_>) -> PyResult<Built> {
        let Self { natural, sab } = self;
        build::<_, _, 2>(Blackjack { natural, sab }, Cells(Blackjack::CELLS.map(|count| count as u32)), plan)
    }
}

impl Bias {
    pub(crate) fn build(self, plan: &Plan<'_>) -> PyResult<Built> {
        let Self { actions, mean, deviation } = self;
        let env = MaximizationBias { actions, mean, deviation };
        build::<_, _, 0>(env, Identity(MAXIMIZATION_BIAS_STATES), plan)
    }
}

/// The article's learner of `N` actions is compiled whole, and its next of kin with other policies.
fn build<E, F, const N: usize>(env: E, features: F, plan: &Plan<'_>) -> PyResult<Built>
where
    E: Env<Action = usize, State: Send> + Send + 'static,
    F: Features<E::Observation, Rows = [u32; 1]> + Send + 'static,
{
    if plan.actions != env.actions() {
        return Err(PyValueError::new_err(format!("the environment has {} actions", env.actions())));
    }
    let (rows, mut draw) = (features.len(), plan.stream()?);
    let world = Native::new(env, features, plan.max_episode_steps, plan.environment_stream());
    if let (true, Stream::Pcg64(draw), 0) = (plan.actions == N, &mut draw, plan.record) {
        if let Some(agent) = plan.article::<N>(rows, draw)? {
            let run = whole(world, agent, draw.clone(), plan);
            return Ok(Built { run, kept: Kept::Nothing, attached: false });
        }
        if let Some(agent) = plan.plain::<N, _>(plan.policy()?, rows, draw)? {
            let run = whole(world, agent, draw.clone(), plan);
            return Ok(Built { run, kept: Kept::Nothing, attached: false });
        }
    }
    boxed(world, rows, 1, draw, plan, Kept::Native, false)
}
