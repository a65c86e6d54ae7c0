//! Every run of a batch equals the same run alone, for any settings, wherever the batch is interrupted.

mod runs;

use proptest::prelude::*;

use self::runs::{DEFAULT, Settings, cart_pole, mountain_car, tiled_mountain_car};
use super::batched_run::advance_all_at;
use super::{BatchRule, LANES, SimdTrainer};
use crate::envs::classic_control::{CartPole, MountainCar};
use crate::envs::{Env, SimdEnv};
use crate::features::BatchFeatures;
use crate::learners::{Agent, ExpectedSarsa, Learner, QLearning, Sarsa, UpdateRule};
use crate::policies::EpsilonGreedy;
use crate::q_table::TerminalUpdate;
use crate::schedules::StepSize;
use crate::simd::SimdLevel;
use crate::trainer::Budget;

/// Trains a batch in chunks of steps, then each run alone to its end or its error, and compares with runs that were
/// always alone.
fn check<E, F, A, U, const N: usize, const M: usize, const K: usize>(
    seeds: [u32; K],
    make: impl Fn(u32) -> SimdTrainer<E, F, N, A, U>,
    episodes: usize,
    chunks: &[u64],
) where
    E: SimdEnv<M> + Env<Observation = [f32; M]>,
    F: BatchFeatures<M>,
    A: StepSize,
    U: BatchRule + UpdateRule<F::Active, Agent<N, EpsilonGreedy, A>>,
{
    for level in SimdLevel::available() {
        check_at(level, seeds, &make, episodes, chunks);
    }
}

/// [`check`] at one SIMD level.
fn check_at<E, F, A, U, const N: usize, const M: usize, const K: usize>(
    level: SimdLevel,
    seeds: [u32; K],
    make: impl Fn(u32) -> SimdTrainer<E, F, N, A, U>,
    episodes: usize,
    chunks: &[u64],
) where
    E: SimdEnv<M> + Env<Observation = [f32; M]>,
    F: BatchFeatures<M>,
    A: StepSize,
    U: BatchRule + UpdateRule<F::Active, Agent<N, EpsilonGreedy, A>>,
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
        if alone.learner.diverged() {
            // Both stop, but a run that diverged at the end of a chunk does so without finishing the episode.
            let finished = run.episodes().returns.len();
            assert!(run.learner.diverged() && run.last_episode() == alone.last_episode());
            assert_eq!(run.episodes().returns, alone.episodes().returns[..finished]);
            continue;
        }
        assert_eq!(run.episodes(), alone.episodes());
        assert_eq!(run.rng, alone.rng);
        assert_eq!(run.task.rng, alone.task.rng);
        let bits = |run: &SimdTrainer<E, F, N, A, U>| {
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
        check(seeds, |seed| mountain_car(MountainCar::default(), QLearning, settings, seed), episodes, chunks);
        check(seeds, |seed| cart_pole(CartPole::default(), QLearning, settings, seed), episodes, chunks);
    }
    check([7], |seed| mountain_car(MountainCar::default(), QLearning, DEFAULT, seed), 20, &[u64::MAX]);
}

#[test]
fn runs_with_different_settings_keep_them() {
    let other = Settings { discount: 0.5, ..DEFAULT };
    let make = |seed| mountain_car(MountainCar::default(), QLearning, if seed == 1 { other } else { DEFAULT }, seed);
    check([0, 1], make, 20, &[u64::MAX]);
}

#[test]
fn each_run_keeps_its_learning_rate() {
    let other = Settings { learning_rate: 0.7, ..DEFAULT };
    let make = |seed| cart_pole(CartPole::default(), QLearning, if seed == 1 { other } else { DEFAULT }, seed);
    check([0, 1, 2, 3], make, 20, &[u64::MAX]);
}

#[test]
fn an_observation_without_a_row_fails_as_in_a_single_run() {
    let fast = MountainCar { max_speed: 1.0, force: 0.1, ..MountainCar::default() };
    let settings = Settings { epsilon: 0.0, ..DEFAULT };
    assert!(mountain_car(fast, QLearning, settings, 0).advance(Budget { episodes: 20, work: u64::MAX }).is_err());
    check([0, 1, 2, 3], |seed| mountain_car(fast, QLearning, settings, seed), 20, &[9, u64::MAX]);
    let weightless = CartPole { total_mass: 0.0, ..CartPole::default() };
    assert!(cart_pole(weightless, QLearning, settings, 0).advance(Budget { episodes: 20, work: u64::MAX }).is_err());
    check([0, 1, 2, 3], |seed| cart_pole(weightless, QLearning, settings, seed), 20, &[9, u64::MAX]);
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
        check([0, 1, 2, 3], |seed| mountain_car(env, QLearning, settings, seed), settings.episodes, &chunks);
        check([0, 1, 2, 3], |seed| mountain_car(env, Sarsa, settings, seed), settings.episodes, &chunks);
        check([0, 1, 2, 3], |seed| mountain_car(env, ExpectedSarsa, settings, seed), settings.episodes, &chunks);
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
        check([0, 1, 2, 3], |seed| cart_pole(env, QLearning, settings, seed), settings.episodes, &chunks);
        check([0, 1, 2, 3], |seed| cart_pole(env, Sarsa, settings, seed), settings.episodes, &chunks);
        check([0, 1, 2, 3], |seed| cart_pole(env, ExpectedSarsa, settings, seed), settings.episodes, &chunks);
    }

    #[test]
    fn tilings_with_any_settings_and_chunks(
        hashed in prop_oneof![Just(None), Just(Some(60))],
        by_visit_count in prop_oneof![4 => Just(false), 1 => Just(true)],
        // The larger factors make the run diverge.
        scale in prop_oneof![3 => Just(1.0), 1 => 3.0..100.0],
        settings in any_settings(),
        chunks in chunks(),
    ) {
        let settings = Settings { learning_rate: settings.learning_rate * scale, ..settings };
        let (seeds, episodes) = ([0, 1, 2, 3], settings.episodes);
        check(seeds, |seed| tiled_mountain_car(hashed, by_visit_count, QLearning, settings, seed), episodes, &chunks);
        check(seeds, |seed| tiled_mountain_car(hashed, by_visit_count, Sarsa, settings, seed), episodes, &chunks);
        check(seeds, |seed| tiled_mountain_car(hashed, by_visit_count, ExpectedSarsa, settings, seed), episodes, &chunks);
    }
}
