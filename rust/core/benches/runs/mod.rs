//! What the benchmarks of runs share: agents, and training to the end.
#![allow(dead_code, reason = "each benchmark program uses some of it")]

use std::fmt::Debug;

use qtab_core::batch::{BatchedRun, LANES};
use qtab_core::learners::Agent;
use qtab_core::q_table::TerminalUpdate;
use qtab_core::random::Rng;
use qtab_core::{Budget, Learner, QTable, Task, Trainer};

/// Why a run cannot fail.
const IN_BOUNDS: &str = "every observation has a row, and the run fits into memory";

/// An agent with a table of so many rows and actions, whose values all begin at `value`.
pub(crate) fn agent<const N: usize, P, A>(
    (rows, actions): (usize, usize),
    value: f64,
    policy: P,
    learning_rate: A,
    discount: f64,
) -> Agent<N, P, A> {
    Agent {
        table: QTable::new(vec![value; rows * actions], actions),
        policy,
        learning_rate,
        discount,
        terminal_update: TerminalUpdate::Target,
        masks: None,
    }
}

/// Trains to the end of the budget and returns the number of steps.
pub(crate) fn train<T, L, R>(mut run: Trainer<T, L, R>, budget: Budget) -> u64
where
    T: Task<Error: Debug>,
    L: Learner<T::Active>,
    R: Rng + Clone,
{
    run.advance(budget).expect(IN_BOUNDS);
    steps(&run)
}

/// Trains the runs of eight seeds together, until one of them has finished its episodes. Returns the steps of all.
pub(crate) fn train_batch<T, L, R>(run: impl Fn(u32) -> Trainer<T, L, R>, budget: Budget) -> u64
where
    T: Task,
    L: Learner<T::Active>,
    R: Rng + Clone,
    Trainer<T, L, R>: BatchedRun,
{
    let mut runs: [_; LANES] = std::array::from_fn(|seed| run(seed as u32));
    BatchedRun::advance_all(&mut runs, budget).expect(IN_BOUNDS);
    runs.iter().map(steps).sum()
}

fn steps<T: Task, L: Learner<T::Active>, R: Rng + Clone>(run: &Trainer<T, L, R>) -> u64 {
    run.episodes().lengths.iter().sum::<i64>() as u64
}
