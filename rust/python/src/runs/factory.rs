//! Runs that differ only in their seeds: one after another, or several in a batch.

use pyo3::prelude::*;
use qtab_core::batch::{BatchedRun, LANES};
use qtab_core::memory::MemoryRoom;
use qtab_core::{Budget, StopFlag};

use super::{AnyRecordings, BuiltRun, Run};
use crate::convert::Seed;
use crate::error::RunError;

/// A batch of at least this many runs is faster than single runs.
const HALF: usize = LANES / 2;

/// Builds the runs of one spec in one environment.
pub(crate) trait RunFactory: Send + Sync {
    /// Builds a run. Slow construction stops when `stop` is set.
    fn build(&self, seed: &Seed, stop: &StopFlag<'_>) -> PyResult<BuiltRun>;

    /// An empty batch, whose learners take their memory from `room`.
    fn batch(&self, room: &MemoryRoom) -> Box<dyn RunBatch + '_>;
}

/// Runs that advance together.
pub(crate) trait RunBatch {
    /// The number of runs that is most efficient to advance together.
    fn lanes(&self) -> usize;

    /// Adds a run at the end.
    fn push(&mut self, seed: &Seed, stop: &StopFlag<'_>) -> PyResult<()>;

    /// Advances some of the runs. An error comes with the index of the run that failed; the others may advance further.
    fn advance(&mut self, budget: Budget) -> Result<(), (usize, RunError)>;

    fn run(&self, index: usize) -> &dyn Run;

    /// Removes a run; the last one takes its place.
    fn swap_remove(&mut self, index: usize);
}

/// Advances some of the runs. An error comes with the index of the run that failed.
type AdvanceRuns<R> = fn(&mut [R], Budget) -> Result<(), (usize, RunError)>;

/// The function that advances several runs of type `R` together; `None` to advance one after another.
pub(super) type Batching<R> = Option<AdvanceRuns<R>>;

/// Advances runs in the processor's vector registers, one run per lane.
pub(super) fn advance_lanes<R: Run + BatchedRun>(runs: &mut [R], budget: Budget) -> Result<(), (usize, RunError)> {
    let advanced = if let Some(runs) = runs.first_chunk_mut::<LANES>() {
        R::advance_all(runs, budget)
    } else if let Some(runs) = runs.first_chunk_mut::<HALF>() {
        R::advance_all(runs, budget)
    } else {
        return runs.first_mut().map_or(Ok(()), |run| Run::advance(run, budget).map_err(|error| (0, error)));
    };
    advanced.map_err(|(lane, error)| (lane, error.into()))?;
    for (lane, run) in runs.iter().enumerate() {
        run.check().map_err(|error| (lane, error))?;
    }
    Ok(())
}

/// Makes a factory from a function that builds a run of type `R` from a seed.
pub(super) fn factory<R, B>(build: B, batching: Batching<R>) -> Box<dyn RunFactory>
where
    R: Run + 'static,
    B: Fn(&Seed, &StopFlag<'_>) -> PyResult<R> + Send + Sync + 'static,
{
    match batching {
        Some(advance) => Box::new(LaneFactory { build, advance }),
        None => Box::new(BoxedFactory(move |seed: &Seed, stop: &StopFlag<'_>| {
            Ok((Box::new(build(seed, stop)?) as Box<dyn Run>, AnyRecordings::None))
        })),
    }
}

/// Builds runs that advance in the lanes of vector registers.
struct LaneFactory<R, B> {
    build: B,
    advance: AdvanceRuns<R>,
}

impl<R, B> RunFactory for LaneFactory<R, B>
where
    R: Run + 'static,
    B: Fn(&Seed, &StopFlag<'_>) -> PyResult<R> + Send + Sync,
{
    fn build(&self, seed: &Seed, stop: &StopFlag<'_>) -> PyResult<BuiltRun> {
        let run = Box::new((self.build)(seed, stop)?);
        Ok(BuiltRun { run, recordings: AnyRecordings::None, steps_python: false })
    }

    fn batch(&self, room: &MemoryRoom) -> Box<dyn RunBatch + '_> {
        let runs = Vec::with_capacity(LANES);
        Box::new(LaneBatch { build: &self.build, advance: self.advance, runs, room: room.clone() })
    }
}

/// Builds boxed runs of any type with a function of the seed.
pub(crate) struct BoxedFactory<B>(pub(crate) B);

impl<B> RunFactory for BoxedFactory<B>
where
    B: Fn(&Seed, &StopFlag<'_>) -> PyResult<(Box<dyn Run>, AnyRecordings)> + Send + Sync,
{
    fn build(&self, seed: &Seed, stop: &StopFlag<'_>) -> PyResult<BuiltRun> {
        let (run, recordings) = (self.0)(seed, stop)?;
        Ok(BuiltRun { run, recordings, steps_python: false })
    }

    fn batch(&self, room: &MemoryRoom) -> Box<dyn RunBatch + '_> {
        Box::new(SingleRun { factory: self, run: None, room: room.clone() })
    }
}

/// A batch of at most one run.
struct SingleRun<'a> {
    factory: &'a dyn RunFactory,
    run: Option<Box<dyn Run>>,
    room: MemoryRoom,
}

impl RunBatch for SingleRun<'_> {
    fn lanes(&self) -> usize {
        1
    }

    fn push(&mut self, seed: &Seed, stop: &StopFlag<'_>) -> PyResult<()> {
        let mut run = self.factory.build(seed, stop)?.run;
        run.limit_memory(self.room.clone());
        self.run = Some(run);
        Ok(())
    }

    fn advance(&mut self, budget: Budget) -> Result<(), (usize, RunError)> {
        self.run.as_mut().map_or(Ok(()), |run| run.advance(budget).map_err(|error| (0, error)))
    }

    fn run(&self, _index: usize) -> &dyn Run {
        let Some(run) = &self.run else { unreachable!("a batch is asked for the runs that were added") };
        &**run
    }

    fn swap_remove(&mut self, _index: usize) {
        self.run = None;
    }
}

/// Runs of one type in the lanes of vector registers.
struct LaneBatch<'a, R, B> {
    build: &'a B,
    advance: AdvanceRuns<R>,
    runs: Vec<R>,
    room: MemoryRoom,
}

impl<R, B> RunBatch for LaneBatch<'_, R, B>
where
    R: Run,
    B: Fn(&Seed, &StopFlag<'_>) -> PyResult<R>,
{
    fn lanes(&self) -> usize {
        LANES
    }

    fn push(&mut self, seed: &Seed, stop: &StopFlag<'_>) -> PyResult<()> {
        let mut run = (self.build)(seed, stop)?;
        run.limit_memory(self.room.clone());
        self.runs.push(run);
        Ok(())
    }

    fn advance(&mut self, budget: Budget) -> Result<(), (usize, RunError)> {
        (self.advance)(&mut self.runs, budget)
    }

    fn run(&self, index: usize) -> &dyn Run {
        &self.runs[index]
    }

    fn swap_remove(&mut self, index: usize) {
        self.runs.swap_remove(index);
    }
}
