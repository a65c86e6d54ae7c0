//! The optimum of a transition table, and how near Q-learning comes: `cargo run --release --example planning`.

#![expect(clippy::print_stdout, reason = "a program that shows its results")]

use std::error::Error;

use qtab_core::envs::toy_text::{FrozenLake, LakeRewards};
use qtab_core::features::Identity;
use qtab_core::planning::{finite_horizon, policy_return, value_iteration};
use qtab_core::settings::{LearningRateSpec, ScheduleSpec};
use qtab_core::{StopFlag, Trainer};

const MAX_STEPS: u64 = 200;
const EPISODES: usize = 20_000;

fn main() -> Result<(), Box<dyn Error>> {
    let lake = FrozenLake::new(&FrozenLake::MAP_8X8, Some(FrozenLake::SUCCESS_RATE), LakeRewards::default())?;
    // Set from another thread, it would stop the planning.
    let stop = StopFlag::new();

    let discounted = value_iteration(lake.table(), 0.99, &stop)?;
    println!("discounted value of the start: {:.4}", discounted.values[0]);
    let optimum = finite_horizon(lake.table(), 1.0, MAX_STEPS, &stop)?.expected_return;
    println!("chance to reach the goal within {MAX_STEPS} steps: at most {optimum:.4}");

    let states = u32::try_from(lake.num_states())?;
    let mut trainer = Trainer::builder(lake.clone(), Identity(states))
        .max_episode_steps(MAX_STEPS)
        .episodes(EPISODES as u64)
        .epsilon(ScheduleSpec::linear(1.0, 0.0))
        .learning_rate(LearningRateSpec::by_visit_count(1.0, 0.02))
        .initial_value(1.0)
        .build()?;
    trainer.train(EPISODES)?;
    let policy = trainer.greedy_policy();
    let actions: Vec<usize> = (0..states).map(|state| policy.action([state])).collect();
    let learned = policy_return(lake.table(), &actions, MAX_STEPS, &stop)?;
    println!("chance with what Q-learning found in {EPISODES} episodes: {learned:.4}");
    if !(0.5..=optimum + 1e-9).contains(&learned) {
        return Err("Q-learning should come near the optimum, and cannot exceed it".into());
    }
    Ok(())
}

#[test]
fn q_learning_comes_near_the_optimum() {
    main().expect("the example runs");
}
