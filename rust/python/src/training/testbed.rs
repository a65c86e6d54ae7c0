//! Many runs on the k-armed testbed in one call.

use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};

use numpy::{PyReadwriteArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use qtab_core::{Budget, StopFlag};

use super::WORK_BETWEEN_CHECKS;
use super::env_spec::EnvironmentSpec;
use crate::convert::{Seed, Seeds};
use crate::error::invalid;
use crate::interrupt::{on_threads, run_interruptible};
use crate::locks::{into_inner, lock};
use crate::runs::{AnyRecordings, RunFactory, check_tables};
use crate::spec::{Fields, InitialQSpec, RunSpec};

/// The results of one run.
type Row<'a> = (&'a Seed, &'a mut [f64], &'a mut [bool]);

/// Trains one run for each seed on `threads` threads, and writes the reward of each step and whether its action was
/// optimal into `rewards` and `optimal`, (runs, steps). The numbers equal those of `Trainer`.
#[pyfunction]
pub(crate) fn run_testbeds(
    py: Python<'_>,
    spec: &Bound<'_, PyAny>,
    seeds: Seeds,
    mut rewards: PyReadwriteArray2<'_, f64>,
    mut optimal: PyReadwriteArray2<'_, bool>,
    threads: usize,
) -> PyResult<()> {
    let fields = Fields::new(spec)?;
    let env = EnvironmentSpec::native(&fields, "a k-armed bandit that Rust steps")?;
    let spec = Arc::new(RunSpec::parse(&fields)?);
    let factory = env.testbed_runs(&spec)?;
    let (Seeds(seeds), steps) = (seeds, spec.episodes as usize);
    for (name, shape) in [("rewards", rewards.shape()), ("optimal", optimal.shape())] {
        if shape != [seeds.len(), steps] || steps == 0 {
            return Err(invalid(name, format!("an array of shape ({}, {steps})", seeds.len()), format!("{shape:?}")));
        }
    }
    let rows = rewards.as_slice_mut()?.chunks_exact_mut(steps).zip(optimal.as_slice_mut()?.chunks_exact_mut(steps));
    let rows = seeds.iter().zip(rows).map(|(seed, (rewards, optimal))| (seed, rewards, optimal));
    let (rows, failure) = (Mutex::new(rows), Mutex::new(None));
    let next = || -> Option<Row<'_>> { lock(&rows).next() };
    let has_failed = || lock(&failure).is_some();
    let work = |stop: &StopFlag<'_>| {
        while let Some((seed, rewards, optimal)) = next() {
            if stop.is_set() || has_failed() {
                return;
            }
            if let Err(error) = run_testbed(&*factory, &spec.initial_q, (seed, rewards, optimal), stop) {
                lock(&failure).get_or_insert(error);
                return;
            }
        }
    };
    run_interruptible(py, |stop| on_threads(threads.min(seeds.len()), || work(stop)))?;
    into_inner(failure).map_or(Ok(()), Err)
}

/// Trains until both slices are full, or `stop` is set.
fn run_testbed(
    factory: &dyn RunFactory,
    initial_q: &InitialQSpec,
    (seed, rewards, optimal): Row<'_>,
    stop: &StopFlag<'_>,
) -> PyResult<()> {
    let mut built = factory.build(seed, stop)?;
    let run = &mut *built.run;
    while run.episodes().returns.len() < rewards.len() {
        if stop.is_set() {
            return Ok(());
        }
        run.advance(Budget { episodes: rewards.len(), work: WORK_BETWEEN_CHECKS })?;
    }
    check_tables(run, initial_q)?;
    rewards.copy_from_slice(&run.episodes().returns);
    if let AnyRecordings::OptimalActions(taken) = &built.recordings {
        for (optimal, taken) in optimal.iter_mut().zip(taken.iter()) {
            *optimal = taken.load(Ordering::Relaxed);
        }
    }
    Ok(())
}
