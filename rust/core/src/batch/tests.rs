//! Every run of a batch is the lone run, whatever the setting, and wherever the batch pauses.

use crate::envs::Env;
use crate::envs::SimdEnv;
use crate::envs::classic_control::CartPole;
use crate::envs::classic_control::MountainCar;
use crate::features::Axis;
use crate::features::BatchFeatures;
use crate::features::Bins;
use crate::features::Edges;
use crate::features::Rounding;
use crate::learners::Agent;
use crate::learners::QLearning;
use crate::learners::TdLearner;
use crate::policies::EpsilonGreedy;
use crate::random::Pcg64;
use crate::schedules::Schedule;
use crate::schedules::StepSize;
use crate::tasks::NativeTask;
use crate::trainer::Budget;
use crate::trainer::Trainer;
use proptest::prelude::*;

use super::{Article, Balance, BatchedRun, LANES, SimdTrainer};
use crate::q_table::{QTable, TerminalUpdate};
use crate::random::SeedSequence;

/// What the runs of either kind have in common.
#[derive(Clone, Copy, Debug)]
struct Setting {
    terminal_update: TerminalUpdate,
    learning_rate: f64,
    discount: f64,
    epsilon: f64,
    max_episode_steps: u64,
    episodes: usize,
}

const USUAL: Setting = Setting {
    terminal_update: TerminalUpdate::Assign,
    learning_rate: 0.2,
    discount: 0.9,
    epsilon: 0.8,
    max_episode_steps: 200,
    episodes: 20,
};

fn run<E, F, A, const N: usize, const M: usize>(
    env: E,
    features: F,
    learning_rate: A,
    setting: Setting,
    seed: u32,
) -> SimdTrainer<E, F, N, A>
where
    E: SimdEnv<M> + Env<Observation = [f32; M]>,
    F: BatchFeatures<M>,
    A: StepSize,
{
    let seed = SeedSequence::new(&[seed]);
    let mut rng = Pcg64::new(&seed.child(0));
    let agent = Agent {
        table: QTable::uniform(features.len(), N, -1.0, 1.0, &mut rng),
        policy: EpsilonGreedy::linear(setting.epsilon, 0.0, setting.episodes as u64),
        learning_rate,
        discount: setting.discount,
        terminal_update: setting.terminal_update,
    };
    let task = NativeTask::new(env, features, Some(setting.max_episode_steps), Pcg64::new(&seed));
    Trainer::new(task, TdLearner { agent, rule: QLearning }, rng)
}

fn car(env: MountainCar, setting: Setting, seed: u32) -> Article {
    let grid = Rounding::new([Axis::new(-1.2, 0.6, 10.0), Axis::new(-0.07, 0.07, 100.0)]);
    run(env, grid, setting.learning_rate, setting, seed)
}

fn pole(env: CartPole, setting: Setting, seed: u32) -> Balance {
    // Few edges, none, and more than are counted one by one.
    let bins = [3, 1, 6, 70].map(|bins| Edges::equal_width(-0.21_f32, 0.21, bins));
    let rate = Schedule::linear(setting.learning_rate, 0.0, setting.episodes as u64, 1);
    run(env, Bins::new(bins), rate, setting, seed)
}

/// Batches, then alone to the end, or to where it fails: everything is as if each had been alone all the time.
fn check<E, F, A, const N: usize, const M: usize, const K: usize>(
    seeds: [u32; K],
    make: impl Fn(u32) -> SimdTrainer<E, F, N, A>,
    episodes: usize,
    chunks: &[u64],
) where
    E: SimdEnv<M> + Env<Observation = [f32; M]>,
    F: BatchFeatures<M>,
    A: StepSize,
{
    let mut together = seeds.map(&make);
    let failed =
        chunks.iter().find_map(|&steps| SimdTrainer::advance_all(&mut together, Budget { episodes, steps }).err());
    let end = Budget { episodes, steps: u64::MAX };
    for (lane, (mut one, seed)) in together.into_iter().zip(seeds).enumerate() {
        let outcome = match failed {
            Some((failed, outside)) if failed == lane => Err(outside),
            _ => one.advance(end),
        };
        let mut alone = make(seed);
        // Spelled out, because NaN is not equal to itself.
        assert_eq!(format!("{outcome:?}"), format!("{:?}", alone.advance(end)));
        assert_eq!(one.episodes(), alone.episodes());
        assert_eq!(one.rng, alone.rng);
        assert_eq!(one.task.rng(), alone.task.rng());
        let bits = |run: &SimdTrainer<E, F, N, A>| {
            run.learner.agent.table.values().iter().map(|value| value.to_bits()).collect::<Vec<_>>()
        };
        assert_eq!(bits(&one), bits(&alone));
    }
}

#[test]
fn a_batch_gives_the_lone_runs() {
    for (episodes, chunks) in [(1000, &[u64::MAX][..]), (300, &[5000, 3, u64::MAX])] {
        let setting = Setting { episodes, ..USUAL };
        let seeds = std::array::from_fn::<_, LANES, _>(|seed| seed as u32);
        check(seeds, |seed| car(MountainCar::default(), setting, seed), episodes, chunks);
        check(seeds, |seed| pole(CartPole::default(), setting, seed), episodes, chunks);
    }
    check([7], |seed| car(MountainCar::default(), USUAL, seed), 20, &[u64::MAX]);
}

#[test]
fn runs_that_differ_do_not_share_their_numbers() {
    let other = Setting { discount: 0.5, ..USUAL };
    let make = |seed| car(MountainCar::default(), if seed == 1 { other } else { USUAL }, seed);
    check([0, 1], make, 20, &[u64::MAX]);
}

#[test]
fn each_run_has_a_learning_rate_of_its_own() {
    let other = Setting { learning_rate: 0.7, ..USUAL };
    let make = |seed| pole(CartPole::default(), if seed == 1 { other } else { USUAL }, seed);
    check([0, 1, 2, 3], make, 20, &[u64::MAX]);
}

#[test]
fn what_has_no_row_fails_as_it_does_alone() {
    let fast = MountainCar { max_speed: 1.0, force: 0.1, ..MountainCar::default() };
    let setting = Setting { epsilon: 0.0, ..USUAL };
    assert!(car(fast, setting, 0).advance(Budget { episodes: 20, steps: u64::MAX }).is_err());
    check([0, 1, 2, 3], |seed| car(fast, setting, seed), 20, &[9, u64::MAX]);
    let weightless = CartPole { total_mass: 0.0, ..CartPole::default() };
    assert!(pole(weightless, setting, 0).advance(Budget { episodes: 20, steps: u64::MAX }).is_err());
    check([0, 1, 2, 3], |seed| pole(weightless, setting, seed), 20, &[9, u64::MAX]);
}

fn settings() -> impl Strategy<Value = Setting> {
    let terminal_update = prop_oneof![Just(TerminalUpdate::Assign), Just(TerminalUpdate::Target)];
    let epsilon = prop_oneof![Just(0.0), Just(1.0), 0.0..=1.0];
    let max_episode_steps = prop_oneof![Just(1_u64), Just(200), 2_u64..400];
    (terminal_update, 0.0..=1.0, 0.0..=1.0, epsilon, max_episode_steps).prop_map(
        |(terminal_update, learning_rate, discount, epsilon, max_episode_steps)| {
            let episodes = USUAL.episodes;
            Setting { terminal_update, learning_rate, discount, epsilon, max_episode_steps, episodes }
        },
    )
}

fn pauses() -> impl Strategy<Value = Vec<u64>> {
    prop::collection::vec(prop_oneof![1_u64..9, 1_u64..3000], 1..6)
}

proptest! {
    #[test]
    fn whatever_the_setting_and_the_pauses_of_cars(
        (force, gravity) in prop_oneof![Just((0.001, 0.0025)), (0.0..0.01, -0.01..0.01)],
        (goal_position, goal_velocity) in prop_oneof![Just((0.5, 0.0)), (-1.3..0.7, -0.07..0.07)],
        max_speed in prop_oneof![9 => Just(0.07), 1 => 0.06..0.09],
        setting in settings(),
        chunks in pauses(),
    ) {
        let env = MountainCar { max_speed, goal_position, goal_velocity, force, gravity, ..MountainCar::default() };
        check([0, 1, 2, 3], |seed| car(env, setting, seed), setting.episodes, &chunks);
    }

    #[test]
    fn whatever_the_setting_and_the_pauses_of_poles(
        gravity in prop_oneof![3 => Just(9.8), 1 => -20.0..20.0, 1 => Just(1e300)],
        force_mag in prop_oneof![3 => Just(10.0), 1 => 0.0..20.0, 1 => Just(1e300)],
        theta_threshold_radians in prop_oneof![Just(0.2), Just(f64::INFINITY), 0.0..4.0],
        euler in any::<bool>(),
        sutton_barto_reward in any::<bool>(),
        setting in settings(),
        chunks in pauses(),
    ) {
        let env = CartPole {
            gravity, force_mag, theta_threshold_radians, euler, sutton_barto_reward, ..CartPole::default()
        };
        check([0, 1, 2, 3], |seed| pole(env, setting, seed), setting.episodes, &chunks);
    }
}
