//! The contents of responses: a JSON object, and arrays that it names by their addresses.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::learners::greedy::{Episode, StateFeatures, mean_action_value};
use crate::map::Cells;
use crate::map::best::Best;
use crate::runs::run::Progress;
use crate::runs::{State, Training};
use crate::updates::{Update, Watch};

/// The longest greedy episode that a page shows, in steps.
const MAX_SHOWN_STEPS: u64 = 2000;
/// The action of a cell without an action.
const NO_ACTION: u8 = u8::MAX;

enum Array {
    F64(Vec<f64>),
    I32(Vec<i32>),
    U8(Vec<u8>),
}

/// The arrays of a response by their names. They are not moved until the next call.
#[derive(Default)]
pub(crate) struct Arrays(Vec<(&'static str, Array)>);

impl Arrays {
    pub(crate) fn clear(&mut self) {
        self.0.clear();
    }

    fn add(&mut self, name: &'static str, array: Array) {
        self.0.push((name, array));
    }

    pub(crate) fn floats(&self, name: &str) -> Option<&[f64]> {
        self.0.iter().find_map(|(known, array)| match array {
            Array::F64(values) if *known == name => Some(values.as_slice()),
            _ => None,
        })
    }

    /// The entry `"name": ["type", address, length]` of each array.
    fn described(&self) -> Described {
        let described = |array: &Array| match array {
            Array::F64(values) => ("f64", values.as_ptr().addr(), values.len()),
            Array::I32(values) => ("i32", values.as_ptr().addr(), values.len()),
            Array::U8(values) => ("u8", values.as_ptr().addr(), values.len()),
        };
        self.0.iter().map(|(name, array)| (*name, described(array))).collect()
    }
}

type Described = BTreeMap<&'static str, (&'static str, usize, usize)>;

/// The progress of training, with the requested data besides the arrays.
#[derive(Serialize)]
pub(crate) struct Report {
    state: State,
    done: usize,
    columns: Option<usize>,
    rows: Option<usize>,
    episode: Option<GreedyEpisode>,
    best: Option<BestReturn>,
    current: Option<Current>,
    arrays: Described,
}

#[derive(Serialize)]
struct GreedyEpisode {
    components: usize,
    terminated: bool,
    truncated: bool,
    r#return: f64,
}

#[derive(Serialize)]
struct BestReturn {
    kind: &'static str,
    r#return: Option<f64>,
}

/// The unfinished episode of the first run.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Current {
    cell: usize,
    next_action: Option<usize>,
    step: i64,
    episode_return: f64,
}

/// The last updates of a cell.
#[derive(Serialize)]
pub(crate) struct Inspection<'a> {
    cell: usize,
    updates: Vec<&'a Update>,
    discount: f64,
    arrays: Described,
}

/// A response that holds only arrays.
#[derive(Serialize)]
pub(crate) struct ArraysAlone {
    arrays: Described,
}

/// The progress of training, with the returns, the map and the greedy episode if requested.
pub(crate) fn report(
    training: &Training,
    best: Option<Best>,
    [returns, map, episode]: [bool; 3],
    arrays: &mut Arrays,
) -> Report {
    let done = training.done();
    if returns {
        add_returns(training, done, arrays);
    }
    if map {
        add_map(training, arrays);
    }
    let best = best.map(|best| {
        arrays.add("bestValues", Array::F64(best.values));
        arrays.add("bestGreedy", Array::U8(best.greedy));
        BestReturn { kind: best.kind, r#return: best.expected_return }
    });
    Report {
        state: training.state(),
        done,
        columns: map.then(|| training.cells.columns()),
        rows: map.then(|| training.cells.rows()),
        episode: if episode { greedy_episode(training, arrays) } else { None },
        best,
        current: current(training, arrays),
        arrays: arrays.described(),
    }
}

fn add_returns(training: &Training, done: usize, arrays: &mut Arrays) {
    let count = training.runs.len() * done;
    let (mut returns, mut lengths) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for started in &training.runs {
        let log = started.run.episodes();
        // Whole slices are copied several times faster than the numbers of a flattened iterator.
        returns.extend_from_slice(&log.returns[..done]);
        lengths.extend(log.lengths[..done].iter().map(|&length| length as i32));
    }
    arrays.add("returns", Array::F64(returns));
    arrays.add("lengths", Array::I32(lengths));
}

/// The values, visits and greedy actions of the cells in the first run. With two tables the values are their mean, which
/// has the scale of a return and the same greedy actions as their sum.
fn add_map(training: &Training, arrays: &mut Arrays) {
    let run = &training.runs[0].run;
    let (tables, num_actions) = (run.tables(), training.subject.num_actions());
    let (mut values, mut visits, mut greedy) = (Vec::new(), Vec::new(), Vec::new());
    for cell in 0..training.cells.count() {
        let features = training.cells.observation(cell).and_then(|observation| training.subject.features(&observation));
        let features = features.unwrap_or_default();
        let mut best = (NO_ACTION, f64::NAN);
        for action in 0..num_actions {
            let value = mean_action_value(&tables, &features, num_actions, action).filter(|_| !features.is_empty());
            if let Some(value) = value
                && (best.0 == NO_ACTION || value > best.1)
            {
                best = (action as u8, value);
            }
        }
        greedy.push(best.0);
        values.push(best.1);
        let counts = run.visits().map(|counts| count_of(counts, &features, cell, num_actions));
        visits.push(counts.map_or(f64::NAN, |counts| counts.iter().sum()));
    }
    arrays.add("visits", Array::F64(visits));
    arrays.add("values", Array::F64(values));
    arrays.add("greedy", Array::U8(greedy));
    if let Cells::Plane(plane) = &*training.cells {
        arrays.add("xEdges", Array::F64(plane.x_edges.clone()));
        arrays.add("yEdges", Array::F64(plane.y_edges.clone()));
    }
}

/// A cell or a row as JavaScript reads it; their numbers always fit.
fn as_i32(index: usize) -> i32 {
    i32::try_from(index).unwrap_or(i32::MAX)
}

/// The number of times each action was taken in a state: with tile coding, the mean over its tiles; with weighted features,
/// those of its cell.
fn count_of(counts: &[i64], features: &StateFeatures, cell: usize, num_actions: usize) -> Vec<f64> {
    let cell = [cell as u32];
    let rows = if features.weighted().is_some() { &cell[..] } else { &features.rows };
    let count = |row: u32, action| counts.get(row as usize * num_actions + action).copied().unwrap_or(0) as f64;
    let mean = |action| rows.iter().map(|&row| count(row, action)).sum::<f64>() / rows.len().max(1) as f64;
    (0..num_actions).map(mean).collect()
}

fn greedy_episode(training: &Training, arrays: &mut Arrays) -> Option<GreedyEpisode> {
    let tables = training.runs[0].run.tables();
    let steps = training.settings.max_episode_steps.min(MAX_SHOWN_STEPS);
    let Episode { observations, actions, total_reward, terminated } =
        training.subject.greedy_episode(&tables, training.seeds[0], steps)?;
    let components = observations.len() / (actions.len() + 1);
    let cells = observations.chunks(components.max(1)).map(|seen| as_i32(training.cells.cell(seen))).collect();
    let truncated = !terminated && actions.len() as u64 == training.settings.max_episode_steps;
    arrays.add("observations", Array::F64(observations));
    arrays.add("episodeActions", Array::U8(actions));
    arrays.add("episodeCells", Array::I32(cells));
    Some(GreedyEpisode { components, terminated, truncated, r#return: total_reward })
}

fn current(training: &Training, arrays: &mut Arrays) -> Option<Current> {
    let started = &training.runs[0];
    let (Progress { episode_return, steps, next_action }, observation) =
        (started.run.progress()?, (started.observation)()?);
    let cell = training.cells.cell(&observation);
    arrays.add("observation", Array::F64(observation));
    Some(Current { cell, next_action, step: steps, episode_return })
}

/// The action values, visits and last updates of a cell in the first run.
pub(crate) fn inspection<'a>(training: &'a Training, cell: usize, arrays: &mut Arrays) -> Inspection<'a> {
    let run = &training.runs[0].run;
    let num_actions = training.subject.num_actions();
    let observation = training.cells.observation(cell).unwrap_or_default();
    let features = training.subject.features(&observation).unwrap_or_default();
    let tables = run.tables();
    let value = |action| mean_action_value(&tables, &features, num_actions, action).unwrap_or(f64::NAN);
    arrays.add("actionValues", Array::F64((0..num_actions).map(value).collect()));
    let visits = run.visits().map(|counts| count_of(counts, &features, cell, num_actions)).unwrap_or_default();
    arrays.add("visits", Array::F64(visits));
    arrays.add("observation", Array::F64(observation));
    let updates = run.watch().into_iter().flat_map(Watch::updates).collect();
    Inspection { cell, updates, discount: training.settings.discount, arrays: arrays.described() }
}

/// The action values of a run, table by table and row by row.
pub(crate) fn table(training: &Training, index: usize, arrays: &mut Arrays) -> Option<ArraysAlone> {
    let run = &training.runs.get(index)?.run;
    arrays.add("table", Array::F64(run.tables().concat()));
    Some(ArraysAlone { arrays: arrays.described() })
}
