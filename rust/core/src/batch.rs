//! Runs of the article's kind that take turns on one core: while one waits for its chain of operations, others go on.
//!
//! A lone run is bound by latency, the cosine's above all, and by branches that nobody can predict. Side by side, the
//! physics of several cars is computed in the processor's wide registers, what an agent explores is chosen without a
//! branch, and the chains overlap. The results are the lone run's to the bit.

#![expect(clippy::inline_always, reason = "what is compiled for each instruction set must be inlined to be so")]
#![expect(clippy::needless_bitwise_bool, reason = "a lazy operator would be a branch that nobody can predict")]

mod lanes;
mod words;

use crate::Env;
use crate::cosine;
use crate::envs::MountainCar;
use crate::features::{Axis, Features, Outside, Rounding};
use crate::learners::{Agent, Control, EpsilonGreedy, QLearning};
use crate::random::Pcg64;
use crate::trainer::{Trainer, Until};
use crate::worlds::Native;

/// How many runs go together best.
pub const LANES: usize = 8;

/// A reward of -1 a step never brings a value from here to infinity: nobody need look whether a run diverges.
const FAR_FROM_OVERFLOW: f64 = 1e300;

/// The article's run: what a batch is made for.
pub type Article = Trainer<
    Native<MountainCar, Rounding<f32, [Axis<f32>; 2]>>,
    Control<QLearning, Agent<3, EpsilonGreedy, f64>>,
    Pcg64,
>;

/// Advances every run by up to `until.steps` steps, until one of them has `until.episodes`. Each is then where it would
/// be had it advanced alone by as many steps, and may go on with others, or alone.
///
/// Runs that do not differ in their seeds and tables alone, or whose grid does not hold all that the car can reach,
/// advance one after the other.
///
/// # Errors
/// As for [`Trainer::advance`], with the index of the run that failed; the others may go on.
pub fn advance<const K: usize>(runs: &mut [Article; K], until: Until) -> Result<(), (usize, Outside)> {
    if runs.iter().any(|run| run.episodes.returns.len() >= until.episodes) {
        return Ok(());
    }
    if !cosine::TRUSTED || !runs.iter().all(|run| alike(run, &runs[0])) || !holds_all(&runs[0]) {
        let mut lanes = runs.iter_mut().enumerate();
        return lanes.try_for_each(|(lane, run)| run.advance(until).map_err(|outside| (lane, outside)));
    }
    pulp::Arch::new().dispatch(lanes::Turns { runs, until })
}

fn alike(one: &Article, other: &Article) -> bool {
    let (world, agent) = (&one.world, &one.learner.agent);
    let others = &other.learner.agent;
    world.env == other.world.env
        && world.features == other.world.features
        && world.max_episode_steps == other.world.max_episode_steps
        && agent.learning_rate == others.learning_rate
        && agent.discount == others.discount
        && agent.terminal_update == others.terminal_update
        && agent.table.values().len() == others.table.values().len()
        && agent.table.values().iter().all(|value| value.abs() < FAR_FROM_OVERFLOW)
}

/// Whether no observation can lie outside the grid: it rises with position and velocity, so that the corners tell.
fn holds_all(run: &Article) -> bool {
    let (car, grid) = (&run.world.env, &run.world.features);
    let corner = |position, velocity| grid.rows(&car.observe(&[position, velocity].into())).is_ok();
    // Infinite accelerations may cancel to NaN, which no wall stops.
    car.force.is_finite()
        && car.gravity.is_finite()
        && corner(car.min_position, -car.max_speed)
        && corner(car.max_position, car.max_speed)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::learners::TerminalUpdate;
    use crate::random::SeedSequence;
    use crate::{Table, Trainer};

    const INSIDE: &str = "the valley lies inside the grid";

    #[derive(Clone, Copy, Debug)]
    struct Setting {
        car: MountainCar,
        terminal_update: TerminalUpdate,
        learning_rate: f64,
        discount: f64,
        epsilon: f64,
        max_episode_steps: u64,
    }

    const ARTICLE: Setting = Setting {
        car: MountainCar {
            min_position: -1.2,
            max_position: 0.6,
            max_speed: 0.07,
            goal_position: 0.5,
            goal_velocity: 0.0,
            force: 0.001,
            gravity: 0.0025,
        },
        terminal_update: TerminalUpdate::Assign,
        learning_rate: 0.2,
        discount: 0.9,
        epsilon: 0.8,
        max_episode_steps: 200,
    };

    fn run(seed: u32, episodes: u64, setting: Setting) -> Article {
        let seed = SeedSequence::new(&[seed]);
        let mut draw = Pcg64::new(&seed.child(0));
        let grid = Rounding::new([Axis::new(-1.2, 0.6, 10.0), Axis::new(-0.07, 0.07, 100.0)]);
        let agent = Agent {
            table: Table::uniform(Features::<[f32; 2]>::len(&grid), 3, -1.0, 1.0, &mut draw),
            policy: EpsilonGreedy::linear(setting.epsilon, 0.0, episodes),
            learning_rate: setting.learning_rate,
            discount: setting.discount,
            terminal_update: setting.terminal_update,
        };
        let world = Native::new(setting.car, grid, Some(setting.max_episode_steps), Pcg64::new(&seed));
        Trainer::new(world, Control { agent, rule: QLearning }, draw)
    }

    /// Batches, then alone to the end: everything is as if each had been alone all the time.
    fn check<const K: usize>(setting: Setting, episodes: usize, chunks: &[u64]) {
        let mut together: [Article; K] = std::array::from_fn(|seed| run(seed as u32, episodes as u64, setting));
        for &steps in chunks {
            advance(&mut together, Until { episodes, steps }).expect(INSIDE);
        }
        for (seed, mut one) in together.into_iter().enumerate() {
            one.advance(Until { episodes, steps: u64::MAX }).expect(INSIDE);
            let mut alone = run(seed as u32, episodes as u64, setting);
            alone.advance(Until { episodes, steps: u64::MAX }).expect(INSIDE);
            assert_eq!(one.episodes(), alone.episodes());
            assert_eq!(one.draw, alone.draw);
            assert_eq!(one.world.draw(), alone.world.draw());
            let bits = |run: &Article| {
                run.learner.agent.table.values().iter().map(|value| value.to_bits()).collect::<Vec<_>>()
            };
            assert_eq!(bits(&one), bits(&alone));
        }
    }

    #[test]
    fn a_batch_gives_the_lone_runs() {
        check::<LANES>(ARTICLE, 1000, &[u64::MAX]);
        check::<4>(ARTICLE, 300, &[5000, 3, u64::MAX]);
        check::<1>(ARTICLE, 50, &[u64::MAX]);
    }

    #[test]
    fn a_car_that_may_leave_the_grid_is_left_to_the_lone_loop() {
        let setting = Setting { car: MountainCar { max_speed: 1.0, ..ARTICLE.car }, ..ARTICLE };
        let mut runs: [Article; 2] = std::array::from_fn(|seed| run(seed as u32, 9, setting));
        assert!(!holds_all(&runs[0]));
        advance(&mut runs, Until { episodes: 9, steps: 1 }).expect(INSIDE);
        assert!(runs[0].underway.is_some());
    }

    #[test]
    fn runs_that_differ_do_not_share_their_numbers() {
        let other = Setting { discount: 0.5, ..ARTICLE };
        let mut runs = [run(0, 20, ARTICLE), run(1, 20, other)];
        advance(&mut runs, Until { episodes: 20, steps: u64::MAX }).expect(INSIDE);
        let mut alone = run(1, 20, other);
        alone.advance(Until { episodes: 20, steps: u64::MAX }).expect(INSIDE);
        assert_eq!(runs[1].learner.agent.table, alone.learner.agent.table);
    }

    proptest! {
        #[test]
        fn whatever_the_setting_and_the_pauses(
            (force, gravity) in prop_oneof![Just((0.001, 0.0025)), (0.0..0.01, -0.01..0.01)],
            goal in prop_oneof![Just((0.5, 0.0)), (-1.3..0.7, -0.07..0.07)],
            assign in any::<bool>(),
            learning_rate in 0.0..=1.0,
            discount in 0.0..=1.0,
            epsilon in prop_oneof![Just(0.0), Just(1.0), 0.0..=1.0],
            max_episode_steps in prop_oneof![Just(1_u64), Just(200), 2_u64..400],
            chunks in prop::collection::vec(prop_oneof![1_u64..9, 1_u64..3000], 1..6),
        ) {
            let (goal_position, goal_velocity) = goal;
            let car = MountainCar { goal_position, goal_velocity, force, gravity, ..ARTICLE.car };
            let terminal_update = if assign { TerminalUpdate::Assign } else { TerminalUpdate::Target };
            let setting = Setting { car, terminal_update, learning_rate, discount, epsilon, max_episode_steps };
            check::<4>(setting, 20, &chunks);
        }
    }
}
