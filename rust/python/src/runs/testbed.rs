//! Runs on the k-armed testbed that record whether the optimal action was taken.

use pyo3::prelude::*;
use qtab_core::learners::{AnyAlgorithm, GradientBandit, LearnerVisitor, QLearning, TdLearner};
use qtab_core::random::Pcg64;
use qtab_core::tasks::{KArmedBandit, Testbed};
use qtab_core::{Budget, Learner, StopFlag, Trainer};

use super::agent::generic_agent;
use super::bandit::{is_specialized, with_learner};
use crate::convert::Seed;
use crate::error::{RunError, allocation, invalid};
use crate::rng::{BitGenerator, agent_pcg64, environment_rng};
use crate::spec::RunSpec;

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
    if is_specialized(spec) {
        let learned = with_learner(spec, seed, stop, |rng| Recorded { task, rng, rewards, optimal, stop })?;
        return learned.map_err(PyErr::from);
    }
    let mut rng = agent_pcg64(seed);
    let agent = generic_agent(spec, 1, 1, &mut rng, stop)?;
    let run = Recorded { task, rng, rewards, optimal, stop };
    let learned = match spec.algorithm {
        AnyAlgorithm::QLearning => run.visit(TdLearner { agent, rule: QLearning }),
        AnyAlgorithm::GradientBandit { baseline } => {
            let rule = GradientBandit::new(baseline, 1, stop).map_err(allocation)?;
            run.visit(TdLearner { agent, rule })
        }
        _ => return Err(invalid("algorithm", "'q_learning' or 'gradient_bandit'", "another")),
    };
    learned.map_err(PyErr::from)
}

/// A run before its learner is known, and where its results go.
struct Recorded<'a> {
    task: KArmedBandit<true>,
    rng: Pcg64,
    rewards: &'a mut [f64],
    optimal: &'a mut [bool],
    stop: &'a StopFlag<'a>,
}

impl LearnerVisitor<[u32; 1]> for Recorded<'_> {
    type Output = Result<(), RunError>;

    fn visit<L: Learner<[u32; 1]> + Send + 'static>(self, learner: L) -> Result<(), RunError> {
        let Self { task, rng, rewards, optimal, stop } = self;
        let mut trainer = Trainer::new(task, learner, rng);
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
}
