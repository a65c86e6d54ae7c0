//! Requests and responses: start a run, train it for a while, report what it has learned.

use crate::best::Planner;
use crate::json::{Json, write_text};
use crate::report::{Arrays, inspection, report, table};
use crate::settings::SettingError;
use crate::subject::Failure;
use crate::training::{Position, Training};

/// The most work of a call: a tenth of a second or less.
const MAX_WORK: u32 = 10_000_000;

/// The run that a page shows, with all its seeds.
#[derive(Default)]
pub struct Playground {
    training: Option<Training>,
    planner: Planner,
    arrays: Arrays,
}

impl Playground {
    /// Answers a request, a JSON object whose member `call` says what to do:
    ///
    /// - `start` makes new runs of an `environment`, `settings` and `seeds`; the first one watches the updates of the cell
    ///   in `inspect`, or of its first state;
    /// - `advance` trains them until `work` is done or `episodes` are finished, `step` by one step each;
    /// - `report` returns what was learned, with `returns`, `map`, `episode` and `best` where these are true;
    /// - `inspect` returns the last updates of a `cell`, or that it has not found them yet with so much `work`;
    /// - `table` returns the action values of the run of index `seed`;
    /// - `version` returns the version of the package that the module was built from.
    ///
    /// The response is a JSON object. It has a member `error` where the request was refused.
    pub fn call(&mut self, request: &[u8]) -> String {
        self.arrays.clear();
        match self.answer(request) {
            Ok(response) => response,
            Err(error) => {
                let mut response = "{\"error\":".to_string();
                write_text(&mut response, &error.message);
                if let Some(setting) = &error.setting {
                    response.push_str(",\"setting\":");
                    write_text(&mut response, setting);
                }
                response + "}"
            }
        }
    }

    /// An array of float64 of the last response, by its name: what JavaScript reads by its address.
    pub fn floats(&self, name: &str) -> Option<&[f64]> {
        self.arrays.floats(name)
    }

    fn answer(&mut self, request: &[u8]) -> Result<String, SettingError> {
        let request = Json::parse(request).ok_or_else(|| "the request must be JSON".to_string())?;
        let integer = |name: &str, default: u32, most: u32| match request.get(name) {
            None | Some(Json::Null) => Ok(default),
            Some(given) => given.integer(most).ok_or_else(|| format!("{name} must be an integer from 0 to {most}")),
        };
        let flag = |name: &str| request.get(name) == Some(&Json::Bool(true));
        match request.get("call").and_then(Json::text).unwrap_or_default() {
            "start" => {
                self.training = None;
                let training = self.training.insert(Training::new(&request)?);
                return Ok(training.described());
            }
            "version" => return Ok(concat!("{\"version\":\"", env!("CARGO_PKG_VERSION"), "\"}").into()),
            "advance" => {
                let (work, episodes) = (integer("work", 10_000, MAX_WORK)?, integer("episodes", u32::MAX, u32::MAX)?);
                self.started()?.advance(episodes as usize, work.into())?;
            }
            "step" => self.started()?.step()?,
            "report" => {
                let Some(training) = &self.training else { return Err(not_started()) };
                let best = if flag("best") { self.planner.of(training) } else { None };
                let parts = [flag("returns"), flag("map"), flag("episode")];
                return Ok(report(training, best, parts, &mut self.arrays));
            }
            "inspect" => {
                let (cell, work) = (integer("cell", u32::MAX, u32::MAX)?, integer("work", 10_000, MAX_WORK)?);
                let training = self.started()?;
                let position = training.inspect(cell as usize, work.into())?;
                if position == Position::Reached {
                    let Some(training) = &self.training else { return Err(not_started()) };
                    return Ok(inspection(training, cell as usize, &mut self.arrays));
                }
                return Ok("{\"state\":\"replaying\"}".into());
            }
            "table" => {
                let index = integer("seed", 0, u32::MAX)?;
                let Some(training) = &self.training else { return Err(not_started()) };
                return table(training, index as usize, &mut self.arrays)
                    .ok_or_else(|| "no such run".to_string().into());
            }
            _ => return Err("call must be one of the playground's".to_string().into()),
        }
        let training = self.started()?;
        Ok(format!("{{\"state\":\"{}\",\"done\":{}}}", training.state().word(), training.done()))
    }

    fn started(&mut self) -> Result<&mut Training, SettingError> {
        self.training.as_mut().ok_or_else(not_started)
    }
}

fn not_started() -> SettingError {
    "nothing was started".to_string().into()
}

impl From<Failure> for SettingError {
    fn from(Failure(message): Failure) -> Self {
        message.into()
    }
}
