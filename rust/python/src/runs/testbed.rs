//! Runs on the k-armed testbed that record whether the optimal action was taken, compiled for what bandits are taught with.

use pyo3::prelude::*;
use qtab_core::learners::{Agent, AnyAlgorithm, GradientBandit, QLearning, TdLearner};
use qtab_core::random::Pcg64;
use qtab_core::tasks::{KArmedBandit, Testbed};
use qtab_core::{Budget, Learner, QTable, StopFlag, Trainer};

use super::agent::generic_agent;
use crate::convert::Seed;
use crate::error::{RunError, allocation, invalid};
use crate::rng::{BitGenerator, agent_pcg64, environment_rng};
use crate::spec::RunSpec;

/// The number of actions in the book, with which the loops over actions are unrolled.
const BOOK_ACTIONS: usize = 10;

/// Trains until both slices are full, or `stop` is set: the reward of each step, and whether its action was optimal.
pub(crate) fn run_testbed(
    testbed: Testbed,
    spec: &RunSpec,
    seed: &Seed,
    (rewards, optimal): (&mut [f64], &mut [bool]),
    stop: &StopFlag<'_>,
) -> PyResult<()> {
    let task = KArmedBandit::new(testbed, environment_rng(seed)).recording(rewards.len()).map_err(allocation)?;
    if spec.bit_generator != BitGenerator::Pcg64 {
        return Err(invalid("bit_generator", "'PCG64'", "'MT19937'"));
    }
    let mut rng = agent_pcg64(seed);
    let agent = generic_agent(spec, 1, 1, &mut rng, stop)?;
    let learned = match spec.algorithm {
        AnyAlgorithm::QLearning if spec.num_actions == BOOK_ACTIONS => {
            let Agent { table, policy, learning_rate, discount, terminal_update, .. } = agent;
            let table = QTable::<BOOK_ACTIONS>::new(table.values().to_vec(), BOOK_ACTIONS);
            let agent = Agent { table, policy, learning_rate, discount, terminal_update, masks: None };
            train(Trainer::new(task, TdLearner { agent, rule: QLearning }, rng), rewards, optimal, stop)
        }
        AnyAlgorithm::QLearning => {
            train(Trainer::new(task, TdLearner { agent, rule: QLearning }, rng), rewards, optimal, stop)
        }
        AnyAlgorithm::GradientBandit { baseline } => {
            let rule = GradientBandit::new(baseline, 1, stop).map_err(allocation)?;
            train(Trainer::new(task, TdLearner { agent, rule }, rng), rewards, optimal, stop)
        }
        _ => return Err(invalid("algorithm", "'q_learning' or 'gradient_bandit'", "another")),
    };
    learned.map_err(PyErr::from)
}

fn train<L: Learner<[u32; 1]>>(
    mut trainer: Trainer<KArmedBandit, L, Pcg64>,
    rewards: &mut [f64],
    optimal: &mut [bool],
    stop: &StopFlag<'_>,
) -> Result<(), RunError> {
    while trainer.episodes().returns.len() < rewards.len() {
        if stop.is_set() {
            return Ok(());
        }
        trainer.advance(Budget { episodes: rewards.len(), work: crate::training::WORK_BETWEEN_CHECKS })?;
    }
    rewards.copy_from_slice(&trainer.episodes().returns);
    optimal.copy_from_slice(trainer.task().took_optimal());
    Ok(())
}
