//! Requests and responses: start a run, train it for a while, report what it has learned.

use serde::Serialize;
use serde_json::Value;

use crate::failure::Failure;
use crate::json::{integer, written};
use crate::map::best::Planner;
use crate::report::{Arrays, inspection, report, table};
use crate::runs::{Position, State, Training};

/// The largest amount of work per call: a tenth of a second or less.
const MAX_WORK: u32 = 10_000_000;

#[derive(Serialize)]
struct Version {
    version: &'static str,
}

#[derive(Serialize)]
struct Advanced {
    state: State,
    done: usize,
}

/// The response to an inspection while the updates of the cell are not found yet.
#[derive(Serialize)]
struct Replaying {
    state: &'static str,
}

/// The run that a page shows, with all its seeds.
#[derive(Default)]
pub struct Playground {
    training: Option<Training>,
    planner: Planner,
    arrays: Arrays,
}

impl Playground {
    /// Answers a request, a JSON object whose member `call` names the action:
    ///
    /// - `start` makes new runs of an `environment`, `settings` and `seeds`; the first one watches the updates of the
    ///   cell in `inspect`, or of its first state;
    /// - `advance` trains the runs until `work` is done or `episodes` are finished; `step` advances each by one step;
    /// - `report` returns the progress, and `returns`, `map`, `episode` and `best` where these are true;
    /// - `inspect` returns the last updates of a `cell`, or reports that they were not found within `work`;
    /// - `table` returns the action values of the run with index `seed`;
    /// - `version` returns the version of the package that the module was built from.
    ///
    /// The response is a JSON object. If the request was rejected, it has a member `error`.
    pub fn call(&mut self, request: &[u8]) -> String {
        self.arrays.clear();
        self.answer(request).unwrap_or_else(|error| written(&error))
    }

    /// An array of float64 from the last response, by its name. JavaScript reads it by its address.
    pub fn floats(&self, name: &str) -> Option<&[f64]> {
        self.arrays.floats(name)
    }

    fn answer(&mut self, request: &[u8]) -> Result<String, Failure> {
        let request: Value =
            serde_json::from_slice(request).map_err(|error| format!("the request must be JSON: {error}"))?;
        let bounded = |name: &str, default: u32, most: u32| match request.get(name) {
            None | Some(Value::Null) => Ok(default),
            Some(given) => integer(given, most).ok_or_else(|| format!("{name} must be an integer from 0 to {most}")),
        };
        let flag = |name: &str| request.get(name) == Some(&Value::Bool(true));
        match request.get("call").and_then(Value::as_str).unwrap_or_default() {
            "start" => {
                self.training = None;
                self.training = Some(Training::new(&request)?);
            }
            "version" => return Ok(written(&Version { version: env!("CARGO_PKG_VERSION") })),
            "advance" => {
                let (work, episodes) = (bounded("work", 10_000, MAX_WORK)?, bounded("episodes", u32::MAX, u32::MAX)?);
                self.started()?.advance(episodes as usize, work.into())?;
            }
            "step" => self.started()?.step()?,
            "report" => {
                let Some(training) = &self.training else { return Err(not_started()) };
                let best = if flag("best") {
                    self.planner.of(&training.environment, &training.settings, &training.cells)
                } else {
                    None
                };
                let parts = [flag("returns"), flag("map"), flag("episode")];
                return Ok(written(&report(training, best, parts, &mut self.arrays)));
            }
            "inspect" => {
                let (cell, work) = (bounded("cell", u32::MAX, u32::MAX)?, bounded("work", 10_000, MAX_WORK)?);
                let training = self.started()?;
                let position = training.inspect(cell as usize, work.into())?;
                if position == Position::Reached {
                    let Some(training) = &self.training else { return Err(not_started()) };
                    return Ok(written(&inspection(training, cell as usize, &mut self.arrays)));
                }
                return Ok(written(&Replaying { state: "replaying" }));
            }
            "table" => {
                let index = bounded("seed", 0, u32::MAX)?;
                let Some(training) = &self.training else { return Err(not_started()) };
                let table = table(training, index as usize, &mut self.arrays);
                return table.map(|table| written(&table)).ok_or_else(|| "no such run".into());
            }
            _ => return Err("call must be one of the playground's".into()),
        }
        let training = self.started()?;
        Ok(written(&Advanced { state: training.state(), done: training.done() }))
    }

    fn started(&mut self) -> Result<&mut Training, Failure> {
        self.training.as_mut().ok_or_else(not_started)
    }
}

fn not_started() -> Failure {
    "nothing was started".into()
}
