//! The speed of `MountainCar` in steps per second: the parts of a step, the article's training run, and its lower
//! bounds.
//!
//! `cargo bench --bench mountain_car`, or `cargo bench --bench mountain_car -- run` for the training run only.

mod benchmarks;
mod mountain_car_task;
mod runs;

use std::hint::black_box;

use benchmarks::Benchmarks;
use mountain_car_task::{MAX_EPISODE_STEPS, MountainCarTask, agent_rng, rounding, task};
use qtab_core::envs::classic_control::{MountainCar, MountainCarState};
use qtab_core::learners::{Agent, QLearning, TdLearner};
use qtab_core::policies::EpsilonGreedy;
use qtab_core::q_table::TerminalUpdate;
use qtab_core::random::{Mt19937, Pcg64, Rng, SeedSequence};
use qtab_core::tasks::{Next, Task, Transition};
use qtab_core::{Budget, Env, Features, Learner, QTable, Trainer};
use runs::{train, train_batch};

/// Why a reset or a step cannot fail.
const IN_BOUNDS: &str = "every state of the car is in bounds";
const EPISODES: usize = 500;
const BUDGET: Budget = Budget { episodes: EPISODES, work: u64::MAX };
/// Small enough for the first-level cache, large enough that a branch predictor cannot memorize it.
const BATCH: usize = 4096;

type QLearningRun<R> = Trainer<MountainCarTask, QLearner, R>;
type QLearner = TdLearner<QLearning, Agent<3, EpsilonGreedy, f64>>;

fn learner(rng: &mut impl Rng) -> QLearner {
    let agent = Agent {
        table: QTable::uniform(Features::<[f32; 2]>::len(&rounding()), 3, -1.0, 1.0, rng),
        policy: EpsilonGreedy::linear(0.8, 0.0, EPISODES as u64),
        learning_rate: 0.2,
        discount: 0.9,
        terminal_update: TerminalUpdate::Assign,
        masks: None,
    };
    TdLearner { agent, rule: QLearning }
}

/// The active row of a state, the action taken, and the transition.
type WalkStep = ([u32; 1], usize, Transition<[u32; 1]>);

/// Random states and actions.
fn states(rng: &mut Pcg64) -> Vec<(MountainCarState, usize)> {
    let state =
        |rng: &mut Pcg64| MountainCarState { position: rng.uniform(-1.2, 0.6), velocity: rng.uniform(-0.07, 0.07) };
    (0..BATCH).map(|_| (state(rng), rng.integers(3) as usize)).collect()
}

/// One step of many independent cars.
fn physics(benchmarks: &mut Benchmarks) {
    let mut rng = agent_rng();
    let (car, states) = (MountainCar::default(), states(&mut rng));
    benchmarks.add("physics", "step", || {
        for &(state, action) in &states {
            black_box(car.step(state, action, &mut rng));
        }
        BATCH as u64
    });
}

/// Converts observations to rows.
fn discretizer(benchmarks: &mut Benchmarks) {
    let (car, rounding) = (MountainCar::default(), rounding());
    let observations: Vec<_> = states(&mut agent_rng()).iter().map(|(state, _)| car.observe(state)).collect();
    benchmarks.add("discretizer", "rows", || {
        for observation in &observations {
            let _ = black_box(rounding.active_rows(observation));
        }
        BATCH as u64
    });
}

/// The steps of a car with random actions.
fn random_walk(rng: &mut Pcg64) -> Vec<WalkStep> {
    let mut task = task(rounding());
    let (mut state, mut active) = task.reset().expect(IN_BOUNDS);
    let mut walk = Vec::with_capacity(BATCH);
    while walk.len() < BATCH {
        let action = rng.integers(3) as usize;
        let transition = task.step(&mut state, action).expect(IN_BOUNDS);
        walk.push((active, action, transition));
        if let Next::NonTerminal(next_active) = transition.next {
            active = next_active;
        } else {
            (state, active) = task.reset().expect(IN_BOUNDS);
        }
    }
    walk
}

/// The update and the choice of the next action, along a random walk.
fn update(benchmarks: &mut Benchmarks) {
    let mut rng = agent_rng();
    let (walk, mut learner) = (random_walk(&mut rng), learner(&mut rng));
    benchmarks.add("update", "learn", || {
        for &(active, action, transition) in &walk {
            black_box(learner.learn(active, action, transition.reward, transition.next, &mut rng));
        }
        BATCH as u64
    });
}

fn trainer<R: Rng + Clone>(mut rng: R) -> QLearningRun<R> {
    let learner = learner(&mut rng);
    Trainer::new(task(rounding()), learner, rng)
}

/// The dynamics only, with actions known in advance and no learning.
fn physics_only(steps: u64, actions: &[usize], rng: &mut Pcg64) -> f64 {
    let car = black_box(MountainCar::default());
    let start = MountainCarState { position: -0.5, velocity: 0.0 };
    let (mut state, mut travelled) = (start, 0.0);
    for step in 0..steps {
        state = car.step(state, actions[step as usize % BATCH], rng).state;
        travelled += state.velocity;
        if step % MAX_EPISODE_STEPS == MAX_EPISODE_STEPS - 1 {
            state = start;
        }
    }
    travelled
}

/// The draws only: whether to explore, half of the time, and the random action.
fn draws_only(steps: u64, rng: &mut Pcg64) -> u32 {
    let greedy_below = black_box(0.5);
    (0..steps).map(|_| if rng.random() < greedy_below { 0 } else { rng.integers(3) }).sum()
}

/// The table only, along steps known in advance: the largest value of the next row, and the update.
fn table_only(walk: &[WalkStep], agent: &mut Agent<3, EpsilonGreedy, f64>) {
    for &(active, action, transition) in walk {
        if let Next::NonTerminal(next) = transition.next {
            let largest = agent.action_values(next).iter().copied().fold(f64::NEG_INFINITY, f64::max);
            agent.update(active, action, transition.reward + agent.discount * largest);
        }
    }
}

/// The article's training run, and its lower bounds: each of its parts alone.
fn run(benchmarks: &mut Benchmarks) {
    let steps = train(trainer(agent_rng()), BUDGET);
    let mut rng = agent_rng();
    let mut agent = learner(&mut rng).agent;
    let actions: Vec<_> = (0..BATCH).map(|_| rng.integers(3) as usize).collect();
    benchmarks.add("run", "article, PCG64", || train(trainer(agent_rng()), BUDGET));
    benchmarks.add("run", "lower bound: physics", || {
        black_box(physics_only(steps, &actions, &mut rng));
        steps
    });
    benchmarks.add("run", "lower bound: draws", || {
        black_box(draws_only(steps, &mut rng));
        steps
    });
    let walk = random_walk(&mut agent_rng());
    benchmarks.add("run", "lower bound: table", || {
        table_only(&walk, &mut agent);
        BATCH as u64
    });
    let of_seed = |seed| trainer(Pcg64::new(&SeedSequence::new(&[seed]).child(0)));
    benchmarks.add("run", "article, a batch of 8 on one core", || train_batch(of_seed, BUDGET));
    benchmarks.add("run", "article, MT19937", || train(trainer(Mt19937::new(0)), BUDGET));
}

fn main() {
    let mut benchmarks = Benchmarks::from_env();
    physics(&mut benchmarks);
    discretizer(&mut benchmarks);
    update(&mut benchmarks);
    run(&mut benchmarks);
    benchmarks.finish();
}
