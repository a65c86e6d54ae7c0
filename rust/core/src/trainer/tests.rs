//! Tests of learning from steps in parts, and of the work counted.

use super::*;
use crate::envs::classic_control::MountainCar;
use crate::features::{Axis, Rounding};
use crate::learners::{
    Agent, DynaQ, DynaQPlus, Model, NStepSarsa, PrioritizedSweeping, TdLearner, TransformedSteps, UpdateRule,
};
use crate::policies::{AnyPolicy, TieBreaking};
use crate::q_table::{QTable, TerminalUpdate};
use crate::random::{Pcg64, SeedSequence};
use crate::schedules::{LearningRate, Schedule};
use crate::stop_flag::StopFlag;
use crate::tasks::NativeTask;

const ROWS: usize = 19 * 15;
const ACTIONS: usize = 3;

/// Runs two episodes in one part and in the smallest parts, with a rule whose steps take more work than a learner does
/// in one call.
fn check_parts<U>(rule: &U, steps: u64, terminate: bool)
where
    U: UpdateRule<[u32; 1], Agent> + Clone,
{
    let seed = SeedSequence::new(&[3]);
    let rounding = Rounding::new([Axis::new(-1.2_f32, 0.6, 10.0), Axis::new(-0.07_f32, 0.07, 100.0)]);
    let task = NativeTask::new(MountainCar::default(), rounding, Some(steps), Pcg64::new(&seed));
    let agent = Agent {
        table: QTable::new(vec![0.0; ROWS * ACTIONS], ACTIONS),
        policy: AnyPolicy::EpsilonGreedy { epsilon: Schedule::constant(0.3), ties: TieBreaking::Random },
        learning_rate: LearningRate::scheduled(Schedule::constant(0.1), 1),
        discount: 0.9,
        terminal_update: TerminalUpdate::Target,
        masks: None,
    };
    let learner = TransformedSteps { learner: TdLearner { agent, rule: rule.clone() }, terminate, bonus: None };
    let mut whole = Trainer::new(task, learner, Pcg64::new(&seed));
    let mut in_parts = whole.clone();
    whole.advance(Budget { episodes: 2, work: u64::MAX }).expect("no observation is out of bounds");
    let mut parts = 0;
    while in_parts.episodes().returns.len() < 2 {
        in_parts.advance(Budget { episodes: 2, work: 1 }).expect("no observation is out of bounds");
        parts += 1;
    }
    assert!(parts > 2 * steps, "every step was done in one part");
    assert_eq!(in_parts.episodes(), whole.episodes());
    assert_eq!(in_parts.learner().tables(), whole.learner().tables());
    assert_eq!(in_parts.rng, whole.rng);
}

#[test]
fn a_step_in_parts_is_the_same_step() {
    let stop = StopFlag::new();
    let model = || Model::new(ROWS, ACTIONS, &stop).expect("a small model");
    for terminate in [false, true] {
        check_parts(&DynaQ::new(model(), 20_000), 4, terminate);
        check_parts(&DynaQPlus::new(model(), 20_000, 1e-3, &stop).expect("a small model"), 4, terminate);
        // Every error exceeds the threshold, so the queue is never empty.
        let sweeping = PrioritizedSweeping::new(model(), 20_000, -1.0, &stop).expect("a small model");
        check_parts(&sweeping, 4, terminate);
        check_parts(&NStepSarsa::new(5000), 2000, terminate);
    }
}

#[test]
fn the_work_of_long_steps_is_counted() {
    let stop = StopFlag::new();
    let seed = SeedSequence::new(&[3]);
    let rounding = Rounding::new([Axis::new(-1.2_f32, 0.6, 10.0), Axis::new(-0.07_f32, 0.07, 100.0)]);
    let task = NativeTask::new(MountainCar::default(), rounding, None, Pcg64::new(&seed));
    let agent = Agent {
        table: QTable::new(vec![0.0; ROWS * ACTIONS], ACTIONS),
        policy: AnyPolicy::EpsilonGreedy { epsilon: Schedule::constant(1.0), ties: TieBreaking::First },
        learning_rate: LearningRate::scheduled(Schedule::constant(0.1), 1),
        discount: 0.9,
        terminal_update: TerminalUpdate::Target,
        masks: None,
    };
    let rule = DynaQ::new(Model::new(ROWS, ACTIONS, &stop).expect("a small model"), 99);
    let mut trainer = Trainer::new(task, TdLearner { agent, rule }, Pcg64::new(&seed));
    trainer.advance(Budget { episodes: 1, work: 1000 }).expect("no observation is out of bounds");
    assert_eq!(trainer.episode.map(|episode| episode.length), Some(10));
}
