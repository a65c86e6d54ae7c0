//! Runs that differ only in their seeds, advanced in turn so that all of them have about the same number of episodes.

mod memory;
pub(crate) mod run;
mod shown_task;
mod subject;
mod unsaved;

use std::sync::Arc;

use serde::Serialize;
use serde_json::Value;

use self::run::Run;
use self::subject::{Shown, StartedRun, Subject, subject};
use crate::environment::Environment;
use crate::failure::Failure;
use crate::json::integer;
use crate::map::Cells;
use crate::settings::Settings;
use crate::updates::{Place, Watch};

const MAX_SEEDS: usize = 64;
/// The largest number of episodes of all seeds together: their results take 17 bytes each, and a page copies them.
const MAX_TOTAL_EPISODES: usize = 4_000_000;
/// The number of parts into which a run is divided, so that the seeds take turns.
const TURNS: usize = 100;
/// The first run is watched in the last of this many parts.
const LAST_PART: usize = 10;
/// The largest amount of work before another run has its turn.
const WORK_OF_A_TURN: u64 = 20_000;

/// The runs of a request.
pub(crate) struct Training {
    pub(crate) environment: Environment,
    pub(crate) settings: Settings,
    pub(crate) subject: Box<dyn Subject>,
    pub(crate) cells: Arc<Cells>,
    pub(crate) seeds: Vec<u32>,
    pub(crate) runs: Vec<StartedRun>,
    /// The cell whose updates the first run watches; `None` if no cell of the map has its first state.
    watched: Option<usize>,
    /// A repetition of the first run up to the same step, which watches another cell.
    replay: Option<Replay>,
}

struct Replay {
    cell: usize,
    run: StartedRun,
}

/// The progress of training.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum State {
    Training,
    Finished,
    Diverged,
}

/// Whether a repeated run has reached the step of the first run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Position {
    Reached,
    OnItsWay,
}

impl Training {
    pub(crate) fn new(request: &Value) -> Result<Self, Failure> {
        let environment = Environment::parse(request.get("environment").unwrap_or(&Value::Null))?;
        let settings = Settings::parse(request.get("settings").unwrap_or(&Value::Null), environment.bounds())?;
        let seeds: Option<Vec<u32>> = match request.get("seeds").and_then(Value::as_array) {
            Some(seeds) if (1..=MAX_SEEDS).contains(&seeds.len()) => {
                seeds.iter().map(|seed| integer(seed, u32::MAX)).collect()
            }
            _ => None,
        };
        let invalid = || format!("seeds must hold 1 to {MAX_SEEDS} integers from 0 to 2**32 - 1");
        let seeds = seeds.ok_or_else(invalid)?;
        if settings.episodes * seeds.len() > MAX_TOTAL_EPISODES {
            let most = MAX_TOTAL_EPISODES / seeds.len();
            let message = format!("episodes must be at most {most} for {} seeds", seeds.len());
            return Err(Failure { setting: Some("episodes".into()), message });
        }
        let subject = subject(&environment, &settings.discretizer);
        let subject = subject.ok_or_else(|| "the discretizer does not fit the environment".to_string())?;
        memory::check(&settings, (subject.n_rows(), subject.num_actions()), seeds.len())?;
        let first = subject.first_observation(seeds[0]);
        let cells = Arc::new(Cells::new(&environment, &settings.discretizer, request.get("map"), &first)?);
        let mut training =
            Self { environment, settings, subject, cells, seeds, runs: Vec::new(), watched: None, replay: None };
        training.start(request.get("inspect"))?;
        Ok(training)
    }

    /// Starts the runs. The first one watches the cell to inspect, or that of its first state, in its last episodes:
    /// they usually have as many updates as an inspection shows, and watching more of them would slow the run down.
    fn start(&mut self, inspect: Option<&Value>) -> Result<(), Failure> {
        let first = self.cells.cell(&self.subject.first_observation(self.seeds[0]));
        let cell = inspect.and_then(|inspect| self.cell_of(inspect)).unwrap_or(first);
        let mut watch = self.watch(cell, self.settings.episodes - self.settings.episodes / LAST_PART);
        self.watched = watch.as_ref().map(|_| cell);
        for (index, &seed) in self.seeds.iter().enumerate() {
            let shown = (index == 0).then(|| Shown { cells: &self.cells, watch: watch.take() });
            self.runs.push(self.subject.run(&self.settings, seed, shown)?);
        }
        Ok(())
    }

    /// The cell of `{cell, columns, rows}` from an earlier map; `None` if this map differs.
    fn cell_of(&self, inspect: &Value) -> Option<usize> {
        let index = |name: &str| integer(inspect.get(name)?, u32::MAX).map(|index| index as usize);
        let same = index("columns") == Some(self.cells.columns()) && index("rows") == Some(self.cells.rows());
        index("cell").filter(|&cell| same && self.watch(cell, 0).is_some())
    }

    /// A watch of a cell from an episode on; `None` if the cell has no action values.
    fn watch(&self, cell: usize, from: usize) -> Option<Watch> {
        let observation = self.cells.observation(cell)?;
        let features = self.subject.features(&observation)?;
        let place = if features.weighted().is_some() {
            Place::Cell { watched: cell, left: Arc::default() }
        } else {
            Place::Rows(features.rows)
        };
        Some(Watch::new(place, from))
    }

    /// The smallest number of finished episodes of all runs.
    pub(crate) fn done(&self) -> usize {
        self.runs.iter().map(|started| started.run.episodes().returns.len()).min().unwrap_or(0)
    }

    pub(crate) fn state(&self) -> State {
        if self.runs.iter().any(|started| started.run.diverged()) {
            State::Diverged
        } else if self.done() == self.settings.episodes {
            State::Finished
        } else {
            State::Training
        }
    }

    /// Trains the runs in turn, until `episodes` episodes are finished or this much work is done.
    pub(crate) fn advance(&mut self, episodes: usize, work: u64) -> Result<(), Failure> {
        let episodes = episodes.min(self.settings.episodes);
        let turn = self.settings.episodes.div_ceil(TURNS);
        let mut left = work;
        while left > 0 && self.state() != State::Diverged {
            let done = |started: &StartedRun| started.run.episodes().returns.len();
            let Some(next) = self.runs.iter_mut().min_by_key(|started| done(started)) else { break };
            let before = done(next);
            if before >= episodes {
                break;
            }
            let until = (before / turn + 1).saturating_mul(turn).min(episodes);
            let (run, budget) = (&mut next.run, left.min(WORK_OF_A_TURN));
            let steps_before = steps(run.as_ref(), before);
            run.advance(until, budget)?;
            // The steps of the episodes if they ended the turn, otherwise the whole budget.
            let done_after = run.episodes().returns.len();
            let used =
                if done_after < until { budget } else { steps(run.as_ref(), before).saturating_sub(steps_before) };
            left = left.saturating_sub(used.max(1));
        }
        Ok(())
    }

    /// Takes one step of each run that is not finished.
    pub(crate) fn step(&mut self) -> Result<(), Failure> {
        for started in &mut self.runs {
            step(started.run.as_mut(), self.settings.episodes)?;
        }
        Ok(())
    }

    /// Makes the first run watch a cell. If it has watched another one, or not long enough, it is repeated up to its
    /// last step. The learned values do not change.
    pub(crate) fn inspect(&mut self, cell: usize, work: u64) -> Result<Position, Failure> {
        if self.watched == Some(cell) && self.runs[0].run.watch().is_some_and(Watch::is_complete) {
            return Ok(Position::Reached);
        }
        if self.replay.as_ref().is_none_or(|replay| replay.cell != cell) {
            let watch = self.watch(cell, 0).ok_or("cell must be one with action values")?;
            let shown = Shown { cells: &self.cells, watch: Some(watch) };
            let run = self.subject.run(&self.settings, self.seeds[0], Some(shown))?;
            self.replay = Some(Replay { cell, run });
        }
        let Some(replay) = &mut self.replay else { return Ok(Position::OnItsWay) };
        let (first, run) = (&self.runs[0].run, &mut replay.run.run);
        let done = first.episodes().returns.len();
        run.advance(done, work)?;
        if run.episodes().returns.len() < done {
            return Ok(Position::OnItsWay);
        }
        let goal = first.progress().map_or(0, |progress| progress.steps);
        for _ in 0..work {
            if run.progress().map_or(0, |progress| progress.steps) >= goal {
                if let Some(Replay { run, .. }) = self.replay.take() {
                    self.runs[0] = run;
                }
                self.watched = Some(cell);
                return Ok(Position::Reached);
            }
            step(run.as_mut(), self.settings.episodes)?;
        }
        Ok(Position::OnItsWay)
    }
}

/// The steps of the unfinished episode and of the finished ones from an index on.
fn steps(run: &dyn Run, from: usize) -> u64 {
    let finished: i64 = run.episodes().lengths[from..].iter().sum();
    (finished + run.progress().map_or(0, |progress| progress.steps)) as u64
}

/// Takes one step of a run. The learner may do it in parts.
fn step(run: &mut dyn Run, episodes: usize) -> Result<(), Failure> {
    let position = |run: &dyn Run| (run.episodes().returns.len(), run.progress().map(|progress| progress.steps));
    let is_unfinished = |run: &dyn Run| run.progress().is_some_and(|progress| progress.next_action.is_none());
    let before = position(run);
    while before.0 < episodes && (position(run) == before || is_unfinished(run)) && !run.diverged() {
        run.advance(episodes, 1)?;
    }
    Ok(())
}
