//! What a response holds: a JSON object, and arrays that it names by their address.

use std::fmt::Write;

use crate::best::Best;
use crate::episode::{Episode, mean_action_value};
use crate::json::write_number;
use crate::training::Training;
use crate::updates::{StepEnd, Update, UpdateKind, Watch};

/// The longest greedy episode that a page shows, in steps.
const MAX_SHOWN_STEPS: u64 = 2000;
/// The action of a cell that has none.
const NO_ACTION: u8 = u8::MAX;

enum Array {
    F64(Vec<f64>),
    I32(Vec<i32>),
    U8(Vec<u8>),
}

/// The arrays of a response by their names. They stay where they are until the next call.
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

    /// `"name":["type",address,length]` of each array.
    fn write(&self, out: &mut String) {
        out.push_str("\"arrays\":{");
        for (index, (name, array)) in self.0.iter().enumerate() {
            let (kind, address, length) = match array {
                Array::F64(values) => ("f64", values.as_ptr().addr(), values.len()),
                Array::I32(values) => ("i32", values.as_ptr().addr(), values.len()),
                Array::U8(values) => ("u8", values.as_ptr().addr(), values.len()),
            };
            let comma = if index == 0 { "" } else { "," };
            let _ = write!(out, "{comma}\"{name}\":[\"{kind}\",{address},{length}]");
        }
        out.push('}');
    }
}

/// Where training is, with the returns, the map and the greedy episode if asked for.
pub(crate) fn report(
    training: &Training,
    best: Option<Best>,
    [returns, map, episode]: [bool; 3],
    arrays: &mut Arrays,
) -> String {
    let done = training.done();
    let mut out = format!("{{\"state\":\"{}\",\"done\":{done},", training.state().word());
    if returns {
        add_returns(training, done, arrays);
    }
    if map {
        add_map(training, arrays);
        let _ = write!(out, "\"columns\":{},\"rows\":{},", training.cells.columns(), training.cells.rows());
    }
    if episode {
        write_greedy_episode(training, arrays, &mut out);
    }
    if let Some(best) = best {
        let _ = write!(out, "\"best\":{{\"kind\":\"{}\",\"return\":", best.kind);
        write_number(&mut out, best.expected_return.unwrap_or(f64::NAN));
        out.push_str("},");
        arrays.add("bestValues", Array::F64(best.values));
        arrays.add("bestGreedy", Array::U8(best.greedy));
    }
    write_current(training, arrays, &mut out);
    arrays.write(&mut out);
    out + "}"
}

fn add_returns(training: &Training, done: usize, arrays: &mut Arrays) {
    let logs = || training.runs.iter().map(|started| started.run.episodes());
    arrays.add("returns", Array::F64(logs().flat_map(|log| log.returns[..done].iter().copied()).collect()));
    let lengths = logs().flat_map(|log| log.lengths[..done].iter().map(|&length| length as i32)).collect();
    arrays.add("lengths", Array::I32(lengths));
    let terminated = logs().flat_map(|log| log.terminated[..done].iter().map(|&end| u8::from(end))).collect();
    arrays.add("terminated", Array::U8(terminated));
}

/// The action values, visits and greedy actions of the cells, by the first run. Of two tables it is the mean, which has
/// the scale of a return and the same greedy actions as their sum.
fn add_map(training: &Training, arrays: &mut Arrays) {
    let run = &training.runs[0].run;
    let (tables, num_actions) = (run.tables(), training.subject.num_actions());
    let (mut action_values, mut visits) = (Vec::new(), Vec::new());
    let (mut values, mut greedy) = (Vec::new(), Vec::new());
    for cell in 0..training.cells.count() {
        let rows = training.cells.observation(cell).and_then(|observation| training.subject.active_rows(&observation));
        let rows = rows.unwrap_or_default();
        let mut best = (NO_ACTION, f64::NAN);
        for action in 0..num_actions {
            let value = mean_action_value(&tables, &rows, num_actions, action).filter(|_| !rows.is_empty());
            action_values.push(value.unwrap_or(f64::NAN));
            if let Some(value) = value
                && (best.0 == NO_ACTION || value > best.1)
            {
                best = (action as u8, value);
            }
        }
        greedy.push(best.0);
        values.push(best.1);
        let counts = run.visits().map(|counts| count_of(counts, &rows, num_actions));
        visits.push(counts.map_or(f64::NAN, |counts| counts.iter().sum()));
    }
    arrays.add("actionValues", Array::F64(action_values));
    arrays.add("visits", Array::F64(visits));
    arrays.add("values", Array::F64(values));
    arrays.add("greedy", Array::U8(greedy));
    if let crate::plane::Cells::Plane(plane) = &training.cells {
        arrays.add("xEdges", Array::F64(plane.x_edges.clone()));
        arrays.add("yEdges", Array::F64(plane.y_edges.clone()));
    }
}

/// A cell or a row as JavaScript reads it; there are far fewer than this type has numbers.
fn as_i32(index: usize) -> i32 {
    i32::try_from(index).unwrap_or(i32::MAX)
}

/// How often each action was taken in a state: with tile coding, the mean over its tiles.
fn count_of(counts: &[i64], rows: &[u32], num_actions: usize) -> Vec<f64> {
    let count = |row: u32, action| counts.get(row as usize * num_actions + action).copied().unwrap_or(0) as f64;
    let mean = |action| rows.iter().map(|&row| count(row, action)).sum::<f64>() / rows.len().max(1) as f64;
    (0..num_actions).map(mean).collect()
}

fn write_greedy_episode(training: &Training, arrays: &mut Arrays, out: &mut String) {
    let tables = training.runs[0].run.tables();
    let steps = training.settings.max_episode_steps.min(MAX_SHOWN_STEPS);
    let episode = training.subject.greedy_episode(&tables, training.seeds[0], steps);
    let Some(Episode { observations, actions, total_reward, terminated }) = episode else { return };
    let components = observations.len() / (actions.len() + 1);
    let cells = observations.chunks(components.max(1)).map(|seen| as_i32(training.cells.cell(seen))).collect();
    let truncated = !terminated && actions.len() as u64 == training.settings.max_episode_steps;
    let _ = write!(out, "\"episode\":{{\"components\":{components},\"terminated\":{terminated},");
    let _ = write!(out, "\"truncated\":{truncated},\"return\":");
    write_number(out, total_reward);
    out.push_str("},");
    arrays.add("observations", Array::F64(observations));
    arrays.add("episodeActions", Array::U8(actions));
    arrays.add("episodeCells", Array::I32(cells));
}

/// The unfinished episode of the first run.
fn write_current(training: &Training, arrays: &mut Arrays, out: &mut String) {
    let started = &training.runs[0];
    let (Some(progress), Some(observation)) = (started.run.progress(), (started.observation)()) else { return };
    let cell = training.cells.cell(&observation);
    let next_action = progress.next_action.map_or_else(|| "null".to_string(), |action| action.to_string());
    let steps = progress.steps;
    let _ = write!(out, "\"current\":{{\"cell\":{cell},\"nextAction\":{next_action},\"step\":{steps},");
    out.push_str("\"episodeReturn\":");
    write_number(out, progress.episode_return);
    out.push_str("},");
    arrays.add("observation", Array::F64(observation));
}

/// The action values, visits and last updates of a cell, by the first run.
pub(crate) fn inspection(training: &Training, cell: usize, arrays: &mut Arrays) -> String {
    let run = &training.runs[0].run;
    let num_actions = training.subject.num_actions();
    let observation = training.cells.observation(cell).unwrap_or_default();
    let rows = training.subject.active_rows(&observation).unwrap_or_default();
    let tables = run.tables();
    let value = |action| mean_action_value(&tables, &rows, num_actions, action).unwrap_or(f64::NAN);
    arrays.add("actionValues", Array::F64((0..num_actions).map(value).collect()));
    let visits = run.visits().map(|counts| count_of(counts, &rows, num_actions)).unwrap_or_default();
    arrays.add("visits", Array::F64(visits));
    arrays.add("activeRows", Array::I32(rows.iter().map(|&row| as_i32(row as usize)).collect()));
    arrays.add("observation", Array::F64(observation));
    let mut out = format!("{{\"cell\":{cell},\"updates\":[");
    for (index, update) in run.watch().into_iter().flat_map(Watch::updates).enumerate() {
        if index > 0 {
            out.push(',');
        }
        write_update(training, update, &mut out);
    }
    out.push_str("],");
    arrays.write(&mut out);
    out + "}"
}

fn write_update(training: &Training, update: &Update, out: &mut String) {
    let kind = match update.kind {
        UpdateKind::Target => "target",
        UpdateKind::Trace => "trace",
        UpdateKind::DutchTrace => "dutch_trace",
        UpdateKind::NStep => "n_step",
        UpdateKind::Planning => "planning",
    };
    let end = match update.end {
        StepEnd::Continues => "continues",
        StepEnd::Terminal => "terminal",
        StepEnd::Truncated => "truncated",
        StepEnd::TruncatedAsTerminal => "truncated_as_terminal",
        StepEnd::Other => "other",
    };
    let _ = write!(out, "{{\"kind\":\"{kind}\",\"end\":\"{end}\"");
    let (episode, step, action, table) = (update.episode, update.step, update.action, update.table);
    let _ = write!(out, ",\"episode\":{episode},\"step\":{step},\"action\":{action},\"table\":{table}");
    let numbers = [
        ("old", Some(update.old)),
        ("new", Some(update.new)),
        ("target", Some(update.target)),
        ("learningRate", update.learning_rate),
        ("discount", Some(training.settings.discount)),
        ("reward", update.reward),
        ("nextValue", update.next_value),
        ("trace", update.trace),
        ("qOld", update.q_old),
    ];
    for (name, number) in numbers {
        let _ = write!(out, ",\"{name}\":");
        write_number(out, number.unwrap_or(f64::NAN));
    }
    out.push('}');
}

/// The action values of a run: of each table, row by row.
pub(crate) fn table(training: &Training, index: usize, arrays: &mut Arrays) -> Option<String> {
    let run = &training.runs.get(index)?.run;
    arrays.add("table", Array::F64(run.tables().concat()));
    let mut out = "{".to_string();
    arrays.write(&mut out);
    Some(out + "}")
}
