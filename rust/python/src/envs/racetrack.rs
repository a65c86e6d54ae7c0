//! `qtab/Racetrack-v0`, the racetrack of Exercise 5.12.

use std::sync::Arc;

use pyo3::intern;
use pyo3::prelude::*;
use qtab_core::envs::tabular::{Ground, Racetrack};
use qtab_core::features::Identity;

use super::native_env::NativeEnv;
use crate::error::invalid;
use crate::runs::{RunFactory, generic};
use crate::spec::RunSpec;

pub(crate) struct RacetrackEnv(Racetrack);

impl RacetrackEnv {
    pub(crate) fn from_gymnasium(env: &Bound<'_, PyAny>) -> PyResult<Arc<dyn NativeEnv>> {
        let py = env.py();
        let rows: Vec<String> = env.getattr(intern!(py, "layout"))?.extract()?;
        let columns = rows.first().map_or(0, String::len);
        let ground: Vec<Ground> = rows.iter().flat_map(|row| row.bytes()).map(ground).collect();
        let is_rectangle = rows.iter().all(|row| row.len() == columns);
        let failure = env.getattr(intern!(py, "failure"))?.extract()?;
        let track = u32::try_from(columns).ok().and_then(|columns| Racetrack::new(&ground, columns, failure));
        let track = track.filter(|_| is_rectangle);
        track
            .map(|track| Arc::new(Self(track)) as Arc<dyn NativeEnv>)
            .ok_or_else(|| invalid("layout", "rows of the same length with a starting line", "other rows"))
    }
}

fn ground(cell: u8) -> Ground {
    match cell {
        b'.' => Ground::Track,
        b'S' => Ground::Start,
        b'F' => Ground::Finish,
        _ => Ground::Off,
    }
}

impl NativeEnv for RacetrackEnv {
    fn runs(&self, spec: &Arc<RunSpec>) -> PyResult<Box<dyn RunFactory>> {
        spec.discretizer.check_identity(self.0.num_states() as usize)?;
        generic(self.0.clone(), Identity(self.0.num_states()), spec)
    }
}
