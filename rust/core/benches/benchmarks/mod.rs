//! Benchmarks that Criterion times, or that run a given number of times under an instruction counter.
//!
//! With `QTAB_BENCH=list` a benchmark program prints the names of its benchmarks; with `QTAB_BENCH=NAME` it runs one of
//! them `QTAB_RUNS` times and prints the number of steps. Otherwise Criterion reads the command line.
//! `.ci/run instructions` counts the instructions of one run and of two runs under Valgrind; their difference gives the
//! instructions per step. `QTAB_SIMD=plain` or `=avx2` disables wider vector instructions.
#![expect(clippy::print_stdout, reason = "names and numbers of steps are the program's output")]

use std::env;

use criterion::{Criterion, Throughput};
use qtab_core::simd::{SimdLevel, SimdLimit};

pub(crate) enum Benchmarks {
    Timed(Box<Criterion>),
    Listed,
    Counted { wanted: String, runs: u32, steps: u64 },
}

impl Benchmarks {
    /// The benchmarks in the mode given by the environment variables and the command line.
    pub(crate) fn from_env() -> Self {
        if let Ok(name) = env::var("QTAB_SIMD") {
            SimdLevel::restrict(SimdLimit::from_name(&name).expect("QTAB_SIMD must be a known limit"));
        }
        match env::var("QTAB_BENCH") {
            Err(_) => Self::Timed(Box::new(Criterion::default().configure_from_args())),
            Ok(name) if name == "list" => Self::Listed,
            Ok(wanted) => {
                let runs = env::var("QTAB_RUNS").expect("QTAB_RUNS is set").parse().expect("QTAB_RUNS is a number");
                Self::Counted { wanted, runs, steps: 0 }
            }
        }
    }

    /// Adds a benchmark. `run` returns the number of steps it took.
    pub(crate) fn add(&mut self, group: &str, name: &str, mut run: impl FnMut() -> u64) {
        match self {
            Self::Timed(criterion) => {
                let mut group = criterion.benchmark_group(group);
                group.throughput(Throughput::Elements(run()));
                group.bench_function(name, |bencher| bencher.iter(&mut run));
                group.finish();
            }
            Self::Listed => println!("{group}/{name}"),
            Self::Counted { wanted, runs, steps } => {
                if *wanted == format!("{group}/{name}") {
                    *steps = (0..*runs).map(|_| run()).sum();
                }
            }
        }
    }

    /// Ends the program's output.
    pub(crate) fn finish(self) {
        match self {
            Self::Timed(criterion) => criterion.final_summary(),
            Self::Listed => {}
            Self::Counted { steps, .. } => println!("{steps}"),
        }
    }
}
