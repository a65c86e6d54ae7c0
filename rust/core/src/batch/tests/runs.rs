//! The runs of the tests.

use super::super::SimdTrainer;
use crate::StopFlag;
use crate::envs::classic_control::{CartPole, MountainCar};
use crate::envs::{Env, SimdEnv};
use crate::features::{Axis, BatchFeatures, Bins, Edges, Features, FixedTileCoding, FixedTiles, Rounding, TileCoding};
use crate::learners::{Agent, TdLearner, UpdateRule};
use crate::policies::EpsilonGreedy;
use crate::q_table::{QTable, TerminalUpdate};
use crate::random::{Pcg64, SeedSequence};
use crate::schedules::{LearningRate, Schedule, StepSize};
use crate::tasks::NativeTask;
use crate::trainer::Trainer;

/// The settings of a run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Settings {
    pub(super) terminal_update: TerminalUpdate,
    pub(super) learning_rate: f64,
    pub(super) discount: f64,
    pub(super) epsilon: f64,
    pub(super) max_episode_steps: u64,
    pub(super) episodes: usize,
}

pub(super) const DEFAULT: Settings = Settings {
    terminal_update: TerminalUpdate::Assign,
    learning_rate: 0.2,
    discount: 0.9,
    epsilon: 0.8,
    max_episode_steps: 200,
    episodes: 20,
};

fn run<E, F, A, U, const N: usize, const M: usize>(
    env: E,
    features: F,
    learning_rate: A,
    rule: U,
    settings: Settings,
    seed: u32,
) -> SimdTrainer<E, F, N, A, U>
where
    E: SimdEnv<M> + Env<Observation = [f32; M]>,
    F: BatchFeatures<M>,
    A: StepSize,
    U: UpdateRule<F::Active, Agent<N, EpsilonGreedy, A>>,
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
    Trainer::new(task, TdLearner { agent, rule }, rng)
}

/// Runs on a grid of rounded cells with a constant learning rate.
pub(super) fn mountain_car<U: UpdateRule<[u32; 1], Agent<3, EpsilonGreedy, f64>>>(
    env: MountainCar,
    rule: U,
    settings: Settings,
    seed: u32,
) -> SimdTrainer<MountainCar, Rounding<f32, [Axis<f32>; 2]>, 3, f64, U> {
    let grid = Rounding::new([Axis::new(-1.2, 0.6, 10.0), Axis::new(-0.07, 0.07, 100.0)]);
    run(env, grid, settings.learning_rate, rule, settings, seed)
}

/// Runs on bins with a scheduled learning rate.
pub(super) fn cart_pole<U: UpdateRule<[u32; 1], Agent<2, EpsilonGreedy, Schedule>>>(
    env: CartPole,
    rule: U,
    settings: Settings,
    seed: u32,
) -> SimdTrainer<CartPole, Bins<f32, [Edges; 4]>, 2, Schedule, U> {
    // Few edges, none, and enough for the binary search.
    let bins = [3, 1, 6, 70].map(|bins| Edges::equal_width(-0.21_f32, 0.21, bins));
    let learning_rate = Schedule::linear(settings.learning_rate, 0.0, settings.episodes as u64, 1);
    run(env, Bins::new(bins), learning_rate, rule, settings, seed)
}

/// Runs with tile coding, which may share rows by hashing, and a learning rate chosen at run time. Terminal updates are
/// the usual ones, because a value that is a sum over rows cannot be assigned.
pub(super) fn tiled_mountain_car<U: UpdateRule<FixedTiles<8>, Agent<3, EpsilonGreedy, LearningRate>>>(
    hashed: Option<u32>,
    by_visit_count: bool,
    rule: U,
    settings: Settings,
    seed: u32,
) -> SimdTrainer<MountainCar, FixedTileCoding<f32, 2, 8>, 3, LearningRate, U> {
    let tiles = TileCoding::<f32, 8>::new(&[-1.2, -0.07], &[0.6, 0.07], &[4, 3], 8);
    let tiles = hashed.map_or(tiles.clone(), |rows| tiles.hashed(rows));
    let features = FixedTileCoding::new(&tiles).expect("the numbers of tilings and components match");
    let rows = Features::<[f32; 2]>::len(&features);
    let learning_rate = if by_visit_count {
        LearningRate::by_visit_count(settings.learning_rate, 0.01, 3 * rows, 8, &StopFlag::new())
            .expect("a small table")
    } else {
        let schedule = Schedule::linear(settings.learning_rate, 0.0, settings.episodes as u64, 1);
        LearningRate::scheduled(schedule, 8)
    };
    let settings = Settings { terminal_update: TerminalUpdate::Target, ..settings };
    run(MountainCar::default(), features, learning_rate, rule, settings, seed)
}
