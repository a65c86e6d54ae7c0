//! Runs that differ in their seeds alone: one after the other, or several in a batch.

use pyo3::prelude::*;
use qtab_core::batch::{BatchedRun, LANES};
use qtab_core::memory::MemoryRoom;
use qtab_core::{Budget, StopFlag};

use super::{AnyRecordings, BuiltRun, Run};
use crate::convert::Seed;
use crate::error::RunError;

/// A batch of at least this many runs is faster than single runs.
const HALF: usize = LANES / 2;

/// Builds the runs of one spec in one environment. All of them have one type, which only the factory knows.
pub(crate) trait RunFactory: Send + Sync {
    /// Builds a run. What takes long stops when `stop` is set.
    fn build(&self, seed: &Seed, stop: &StopFlag<'_>) -> PyResult<BuiltRun>;

    /// A batch without runs, whose learners take their memory from this room.
    fn batch(&self, room: &MemoryRoom) -> Box<dyn RunBatch + '_>;
}

/// Runs of one type that advance together.
pub(crate) trait RunBatch {
    /// How many runs advance together best.
    fn lanes(&self) -> usize;

    /// Adds a run at the end.
    fn push(&mut self, seed: &Seed, stop: &StopFlag<'_>) -> PyResult<()>;

    /// Advances some of the runs. An error comes with the index of the run that failed; the others may advance further.
    fn advance(&mut self, budget: Budget) -> Result<(), (usize, RunError)>;

    fn run(&self, index: usize) -> &dyn Run;

    /// Removes a run; the last one takes its place.
    fn swap_remove(&mut self, index: usize);
}

/// Advances some of several runs. An error comes with the index of the run that failed.
type AdvanceRuns<R> = fn(&mut [R], Budget) -> Result<(), (usize, RunError)>;

/// How several runs of type `R` advance.
pub(super) struct Batching<R> {
    lanes: usize,
    advance: AdvanceRuns<R>,
}

impl<R: Run> Batching<R> {
    /// One run at a time.
    pub(super) fn one_by_one() -> Self {
        Self { lanes: 1, advance: advance_first }
    }
}

impl<R: Run + BatchedRun> Batching<R> {
    /// As many runs in the processor's vector registers as there are lanes.
    pub(super) fn in_lanes() -> Self {
        Self { lanes: LANES, advance: advance_lanes }
    }
}

fn advance_first<R: Run>(runs: &mut [R], budget: Budget) -> Result<(), (usize, RunError)> {
    runs.first_mut().map_or(Ok(()), |run| run.advance(budget).map_err(|error| (0, error)))
}

fn advance_lanes<R: Run + BatchedRun>(runs: &mut [R], budget: Budget) -> Result<(), (usize, RunError)> {
    let advanced = if let Some(runs) = runs.first_chunk_mut::<LANES>() {
        R::advance_all(runs, budget)
    } else if let Some(runs) = runs.first_chunk_mut::<HALF>() {
        R::advance_all(runs, budget)
    } else {
        return advance_first(runs, budget);
    };
    advanced.map_err(|(lane, error)| (lane, error.into()))?;
    for (lane, run) in runs.iter().enumerate() {
        run.check().map_err(|error| (lane, error))?;
    }
    Ok(())
}

/// Builds runs of type `R` by a function of the seed.
pub(super) struct Factory<R, B> {
    pub(super) build: B,
    pub(super) batching: Batching<R>,
}

impl<R, B> RunFactory for Factory<R, B>
where
    R: Run + 'static,
    B: Fn(&Seed, &StopFlag<'_>) -> PyResult<(R, AnyRecordings)> + Send + Sync,
{
    fn build(&self, seed: &Seed, stop: &StopFlag<'_>) -> PyResult<BuiltRun> {
        let (run, recordings) = (self.build)(seed, stop)?;
        Ok(BuiltRun { run: Box::new(run), recordings, steps_python: false })
    }

    fn batch(&self, room: &MemoryRoom) -> Box<dyn RunBatch + '_> {
        Box::new(TypedBatch { factory: self, runs: Vec::with_capacity(self.batching.lanes), room: room.clone() })
    }
}

struct TypedBatch<'a, R, B> {
    factory: &'a Factory<R, B>,
    runs: Vec<R>,
    room: MemoryRoom,
}

impl<R, B> RunBatch for TypedBatch<'_, R, B>
where
    R: Run,
    B: Fn(&Seed, &StopFlag<'_>) -> PyResult<(R, AnyRecordings)>,
{
    fn lanes(&self) -> usize {
        self.factory.batching.lanes
    }

    fn push(&mut self, seed: &Seed, stop: &StopFlag<'_>) -> PyResult<()> {
        let (mut run, _) = (self.factory.build)(seed, stop)?;
        run.limit_memory(self.room.clone());
        self.runs.push(run);
        Ok(())
    }

    fn advance(&mut self, budget: Budget) -> Result<(), (usize, RunError)> {
        (self.factory.batching.advance)(&mut self.runs, budget)
    }

    fn run(&self, index: usize) -> &dyn Run {
        &self.runs[index]
    }

    fn swap_remove(&mut self, index: usize) {
        self.runs.swap_remove(index);
    }
}
