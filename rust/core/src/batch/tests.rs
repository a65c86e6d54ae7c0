//! Every run of a batch equals the same run alone, for any settings, wherever the batch is interrupted.

use proptest::prelude::*;

use super::batched_run::advance_all_at;
use super::{LANES, SimdTrainer};
use crate::envs::classic_control::{CartPole, MountainCar};
use crate::envs::{Env, SimdEnv};
use crate::features::{Axis, BatchFeatures, Bins, Edges, Rounding};
use crate::learners::{Agent, QLearning, TdLearner};
use crate::numeric::SimdLevel;
use crate::policies::EpsilonGreedy;
use crate::q_table::{QTable, TerminalUpdate};
use crate::random::{Pcg64, SeedSequence};
use crate::schedules::{Schedule, StepSize};
use crate::tasks::NativeTask;
use crate::trainer::{Budget, Trainer};

/// Runs on a grid of rounded cells with a constant learning rate.
type MountainCarRun = SimdTrainer<MountainCar, Rounding<f32, [Axis<f32>; 2]>, 3, f64>;
/// Runs on bins with a scheduled learning rate.
type CartPoleRun = SimdTrainer<CartPole, Bins<f32, [Edges; 4]>, 2, Schedule>;

/// The settings of a run.
#[derive(Clone, Copy, Debug)]
struct Settings {
    terminal_update: TerminalUpdate,
    learning_rate: f64,
    discount: f64,
    epsilon: f64,
    max_episode_steps: u64,
    episodes: usize,
}

const DEFAULT: Settings = Settings {
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
    settings: Settings,
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
        policy: EpsilonGreedy::linear(settings.epsilon, 0.0, settings.episodes as u64),
        learning_rate,
        discount: settings.discount,
        terminal_update: settings.terminal_update,
        masks: None,
    };
    let task = NativeTask::new(env, features, Some(settings.max_episode_steps), Pcg64::new(&seed));
    Trainer::new(task, TdLearner { agent, rule: QLearning }, rng)
}

fn mountain_car(env: MountainCar, settings: Settings, seed: u32) -> MountainCarRun {
    let grid = Rounding::new([Axis::new(-1.2, 0.6, 10.0), Axis::new(-0.07, 0.07, 100.0)]);
    run(env, grid, settings.learning_rate, settings, seed)
}

fn cart_pole(env: CartPole, settings: Settings, seed: u32) -> CartPoleRun {
    // Few edges, none, and enough for the binary search.
    let bins = [3, 1, 6, 70].map(|bins| Edges::equal_width(-0.21_f32, 0.21, bins));
    let learning_rate = Schedule::linear(settings.learning_rate, 0.0, settings.episodes as u64, 1);
    run(env, Bins::new(bins), learning_rate, settings, seed)
}

/// Trains a batch in chunks of steps, then each run alone to its end or its error, and compares with runs that were
/// always alone.
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
    for level in [SimdLevel::PLAIN, SimdLevel::detect()] {
        check_at(level, seeds, &make, episodes, chunks);
    }
}

/// The same with these vector instructions.
fn check_at<E, F, A, const N: usize, const M: usize, const K: usize>(
    level: SimdLevel,
    seeds: [u32; K],
    make: impl Fn(u32) -> SimdTrainer<E, F, N, A>,
    episodes: usize,
    chunks: &[u64],
) where
    E: SimdEnv<M> + Env<Observation = [f32; M]>,
    F: BatchFeatures<M>,
    A: StepSize,
{
    let mut runs = seeds.map(&make);
    let failed = chunks.iter().find_map(|&work| advance_all_at(level, &mut runs, Budget { episodes, work }).err());
    let end = Budget { episodes, work: u64::MAX };
    for (lane, (mut run, seed)) in runs.into_iter().zip(seeds).enumerate() {
        let result = match failed {
            Some((failed, error)) if failed == lane => Err(error),
            _ => run.advance(end),
        };
        let mut alone = make(seed);
        // Compared as text, because NaN does not equal itself.
        assert_eq!(format!("{result:?}"), format!("{:?}", alone.advance(end)));
        assert_eq!(run.episodes(), alone.episodes());
        assert_eq!(run.rng, alone.rng);
        assert_eq!(run.task.rng(), alone.task.rng());
        let bits = |run: &SimdTrainer<E, F, N, A>| {
            run.learner.agent.table.values().iter().map(|value| value.to_bits()).collect::<Vec<_>>()
        };
        assert_eq!(bits(&run), bits(&alone));
    }
}

#[test]
fn a_batch_equals_single_runs() {
    for (episodes, chunks) in [(1000, &[u64::MAX][..]), (300, &[5000, 3, u64::MAX])] {
        let settings = Settings { episodes, ..DEFAULT };
        let seeds = std::array::from_fn::<_, LANES, _>(|seed| seed as u32);
        check(seeds, |seed| mountain_car(MountainCar::default(), settings, seed), episodes, chunks);
        check(seeds, |seed| cart_pole(CartPole::default(), settings, seed), episodes, chunks);
    }
    check([7], |seed| mountain_car(MountainCar::default(), DEFAULT, seed), 20, &[u64::MAX]);
}

#[test]
fn runs_with_different_settings_keep_them() {
    let other = Settings { discount: 0.5, ..DEFAULT };
    let make = |seed| mountain_car(MountainCar::default(), if seed == 1 { other } else { DEFAULT }, seed);
    check([0, 1], make, 20, &[u64::MAX]);
}

#[test]
fn each_run_keeps_its_learning_rate() {
    let other = Settings { learning_rate: 0.7, ..DEFAULT };
    let make = |seed| cart_pole(CartPole::default(), if seed == 1 { other } else { DEFAULT }, seed);
    check([0, 1, 2, 3], make, 20, &[u64::MAX]);
}

#[test]
fn an_observation_without_a_row_fails_as_in_a_single_run() {
    let fast = MountainCar { max_speed: 1.0, force: 0.1, ..MountainCar::default() };
    let settings = Settings { epsilon: 0.0, ..DEFAULT };
    assert!(mountain_car(fast, settings, 0).advance(Budget { episodes: 20, work: u64::MAX }).is_err());
    check([0, 1, 2, 3], |seed| mountain_car(fast, settings, seed), 20, &[9, u64::MAX]);
    let weightless = CartPole { total_mass: 0.0, ..CartPole::default() };
    assert!(cart_pole(weightless, settings, 0).advance(Budget { episodes: 20, work: u64::MAX }).is_err());
    check([0, 1, 2, 3], |seed| cart_pole(weightless, settings, seed), 20, &[9, u64::MAX]);
}

fn any_settings() -> impl Strategy<Value = Settings> {
    let terminal_update = prop_oneof![Just(TerminalUpdate::Assign), Just(TerminalUpdate::Target)];
    let epsilon = prop_oneof![Just(0.0), Just(1.0), 0.0..=1.0];
    let max_episode_steps = prop_oneof![Just(1_u64), Just(200), 2_u64..400];
    (terminal_update, 0.0..=1.0, 0.0..=1.0, epsilon, max_episode_steps).prop_map(
        |(terminal_update, learning_rate, discount, epsilon, max_episode_steps)| {
            let episodes = DEFAULT.episodes;
            Settings { terminal_update, learning_rate, discount, epsilon, max_episode_steps, episodes }
        },
    )
}

fn chunks() -> impl Strategy<Value = Vec<u64>> {
    prop::collection::vec(prop_oneof![1_u64..9, 1_u64..3000], 1..6)
}

proptest! {
    #[test]
    fn mountain_cars_with_any_settings_and_chunks(
        (force, gravity) in prop_oneof![Just((0.001, 0.0025)), (0.0..0.01, -0.01..0.01)],
        (goal_position, goal_velocity) in prop_oneof![Just((0.5, 0.0)), (-1.3..0.7, -0.07..0.07)],
        max_speed in prop_oneof![9 => Just(0.07), 1 => 0.06..0.09],
        settings in any_settings(),
        chunks in chunks(),
    ) {
        let env = MountainCar { max_speed, goal_position, goal_velocity, force, gravity, ..MountainCar::default() };
        check([0, 1, 2, 3], |seed| mountain_car(env, settings, seed), settings.episodes, &chunks);
    }

    #[test]
    fn cart_poles_with_any_settings_and_chunks(
        gravity in prop_oneof![3 => Just(9.8), 1 => -20.0..20.0, 1 => Just(1e300)],
        force_mag in prop_oneof![3 => Just(10.0), 1 => 0.0..20.0, 1 => Just(1e300)],
        theta_threshold_radians in prop_oneof![Just(0.2), Just(f64::INFINITY), 0.0..4.0],
        euler in any::<bool>(),
        sutton_barto_reward in any::<bool>(),
        settings in any_settings(),
        chunks in chunks(),
    ) {
        let env = CartPole {
            gravity, force_mag, theta_threshold_radians, euler, sutton_barto_reward, ..CartPole::default()
        };
        check([0, 1, 2, 3], |seed| cart_pole(env, settings, seed), settings.episodes, &chunks);
    }
}
