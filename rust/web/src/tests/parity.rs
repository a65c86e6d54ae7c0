//! Learned values equal those of the core, with its parts put together by hand.

use qtab_core::envs::classic_control::{Acrobot, CartPole, MountainCar};
use qtab_core::envs::tabular::{Outcome, TabularMdp};
use qtab_core::features::{Axis, Identity, Rounding, TileCoding};
use qtab_core::learners::{Agent, QLearning, Sarsa, SarsaLambda, TdLearner, TraceKind, Traces};
use qtab_core::numeric::numpy_f32_cos_sin;
use qtab_core::policies::{AnyPolicy, EpsilonGreedy, TieBreaking};
use qtab_core::q_table::TerminalUpdate;
use qtab_core::random::{AgentRng, Pcg64, SeedSequence};
use qtab_core::schedules::{LearningRate, Schedule};
use qtab_core::tasks::NativeTask;
use qtab_core::{Budget, QTable, StopFlag, Trainer};

use super::{ALGORITHMS, ARTICLE, GRID, MOUNTAIN_CAR, call, finish, inspect, of_table, start, table};
use crate::Playground;

const WHOLE: u64 = u64::MAX;

/// An ε-greedy agent with weights of 0, made of the core's parts.
pub(super) fn agent(
    weights: usize,
    num_actions: usize,
    learning_rate: LearningRate,
    discount: f64,
    (epsilon, ties): (f64, TieBreaking),
) -> Agent {
    Agent {
        table: QTable::new(vec![0.0; weights], num_actions),
        policy: AnyPolicy::EpsilonGreedy { epsilon: Schedule::constant(epsilon), ties },
        learning_rate,
        discount,
        terminal_update: TerminalUpdate::Target,
        masks: None,
    }
}

#[test]
fn the_article_learns_what_the_core_learns() {
    let mut playground = Playground::default();
    start(&mut playground, MOUNTAIN_CAR, ARTICLE, "[0, 1, 4294967295]");
    finish(&mut playground, 3000);
    for (index, seed) in [0, 1, u32::MAX].into_iter().enumerate() {
        let seed = SeedSequence::new(&[seed]);
        let mut rng = AgentRng::pcg64(&seed);
        let rounding = Rounding::new([Axis::new(-1.2_f32, 0.6, 10.0), Axis::new(-0.07_f32, 0.07, 100.0)]);
        let task = NativeTask::new(MountainCar::default(), rounding, Some(200), Pcg64::new(&seed));
        let agent = Agent {
            table: QTable::<3>::uniform(19 * 15, 3, -1.0, 1.0, &mut rng),
            policy: EpsilonGreedy::linear(0.8, 0.0, 40),
            learning_rate: 0.2,
            discount: 0.9,
            terminal_update: TerminalUpdate::Assign,
            masks: None,
        };
        let mut trainer = Trainer::new(task, TdLearner { agent, rule: QLearning }, rng);
        trainer.advance(Budget { episodes: 40, work: WHOLE }).expect("MountainCar stays in its space");
        assert_eq!(table(&mut playground, index), trainer.learner().agent.table.values());
    }
}

#[test]
fn traces_on_tile_coding_learn_what_the_core_learns() {
    let settings = r#"{"algorithm": "sarsa_lambda", "trace_decay": 0.9, "traces": "replacing", "trace_cutoff": 0,
        "learning_rate": 0.5, "discount": 0.99, "learning_rate_schedule": "constant", "initial_q": 0,
        "terminal_update": "target", "on_truncation": "bootstrap", "exploration": "epsilon_greedy", "epsilon": 0.1,
        "epsilon_schedule": "constant", "ties": "first", "discretizer": "tiles", "tilings": 8, "tiles": [4],
        "low": [-2.4, -2.5, -0.21, -3.5], "high": [2.4, 2.5, 0.21, 3.5], "episodes": 30, "max_episode_steps": 500,
        "bit_generator": "MT19937"}"#;
    let mut playground = Playground::default();
    start(&mut playground, r#"{"kind": "cart_pole"}"#, settings, "[7]");
    finish(&mut playground, 1_000_000);
    let limits = [2.4, 2.5, 0.21, 3.5];
    let tiles: TileCoding<f32, 8> = TileCoding::new(&limits.map(|limit| -limit), &limits, &[4; 4], 8);
    let task = NativeTask::new(CartPole::default(), tiles, Some(500), Pcg64::new(&SeedSequence::new(&[7])));
    let weights = 8 * 5 * 5 * 5 * 5 * 2;
    let rate = LearningRate::scheduled(Schedule::constant(0.5), 8);
    let agent = agent(weights, 2, rate, 0.99, (0.1, TieBreaking::First));
    let traces = Traces::new(weights, 0.0, &StopFlag::new()).expect("a small table");
    let rule = SarsaLambda { traces, kind: TraceKind::Replacing, trace_decay: 0.9 };
    let mut trainer = Trainer::new(task, TdLearner { agent, rule }, AgentRng::mt19937(7));
    trainer.advance(Budget { episodes: 30, work: WHOLE }).expect("tiles have no bounds");
    assert_eq!(table(&mut playground, 0), trainer.learner().agent.table.values());
}

#[test]
fn a_painted_grid_is_the_mdp_that_it_shows() {
    let corridor =
        r#"{"kind": "grid", "layout": ["S.G#"], "step_reward": -1, "goal_reward": 2, "rewards": [[0, 1, -4]]}"#;
    let mut playground = Playground::default();
    start(&mut playground, corridor, &of_table(r#""sarsa""#), "[3]");
    finish(&mut playground, 100);
    let outcome = |state: i64| {
        let reward = [-1.0, -4.0, 2.0, -1.0][state as usize];
        vec![Outcome { probability: 1.0, state, reward, terminated: state == 2 }]
    };
    // Up and down have no effect; the last cell is a wall, from which only the move to the left is free.
    let pairs: Vec<_> = [[0, 1, 0, 0], [1, 2, 1, 0], [2, 2, 2, 1], [3, 3, 3, 2]].as_flattened().to_vec();
    let pairs: Vec<_> = pairs.into_iter().map(outcome).collect();
    let mdp = TabularMdp::new(4, &[1.0, 0.0, 0.0, 0.0], &pairs).expect("a valid table");
    let seed = SeedSequence::new(&[3]);
    let task = NativeTask::new(mdp, Identity(4), Some(60), Pcg64::new(&seed));
    let rate = LearningRate::scheduled(Schedule::constant(0.5), 1);
    let agent = agent(16, 4, rate, 0.9, (0.3, TieBreaking::Random));
    let mut trainer = Trainer::new(task, TdLearner { agent, rule: Sarsa }, AgentRng::pcg64(&seed));
    trainer.advance(Budget { episodes: 30, work: WHOLE }).expect("every state has a row");
    assert_eq!(table(&mut playground, 0), trainer.learner().agent.table.values());
}

/// Checks that a run learns the same in steps and slices, between inspections of two cells and reports.
pub(super) fn check_parts(environment: &str, settings: &str, cell: usize) {
    let mut whole = Playground::default();
    start(&mut whole, environment, settings, "[5, 6]");
    finish(&mut whole, 10_000_000);
    let mut in_parts = Playground::default();
    start(&mut in_parts, environment, settings, "[5, 6]");
    for round in 0..10 {
        call(&mut in_parts, r#"{"call": "step"}"#);
        inspect(&mut in_parts, cell + round % 2);
        call(&mut in_parts, r#"{"call": "advance", "work": 37}"#);
        call(&mut in_parts, r#"{"call": "report", "returns": true, "map": true, "episode": true, "best": true}"#);
    }
    finish(&mut in_parts, 101);
    for index in 0..2 {
        let learned = table(&mut whole, index);
        assert!(learned.iter().any(|&value| value != 0.0));
        assert_eq!(table(&mut in_parts, index), learned, "{settings}, seed {index}");
    }
}

#[test]
fn steps_slices_and_inspections_change_nothing() {
    for algorithm in ALGORITHMS {
        check_parts(GRID, &of_table(algorithm), 5);
    }
}

#[test]
fn acrobot_learns_what_the_core_learns() {
    let settings = r#"{"algorithm": "sarsa", "learning_rate": 0.5, "discount": 1, "learning_rate_schedule": "constant",
        "initial_q": 0, "terminal_update": "target", "on_truncation": "bootstrap", "exploration": "epsilon_greedy",
        "epsilon": 0.1, "epsilon_schedule": "constant", "ties": "first", "discretizer": "tiles", "tilings": 8,
        "tiles": [3], "low": [-1, -1, -1, -1, -12, -28], "high": [1, 1, 1, 1, 12, 28], "episodes": 10,
        "max_episode_steps": 200, "bit_generator": "PCG64"}"#;
    let mut playground = Playground::default();
    start(&mut playground, r#"{"kind": "acrobot"}"#, settings, "[7]");
    finish(&mut playground, 1_000_000);
    let limits = [1.0, 1.0, 1.0, 1.0, 12.0, 28.0];
    let tiles: TileCoding<f32, 8> = TileCoding::new(&limits.map(|limit: f64| -limit), &limits, &[3; 6], 8);
    // NumPy's cosine and sine of the first observation.
    let env = Acrobot { f32_cos_sin: numpy_f32_cos_sin, ..Acrobot::default() };
    let seed = SeedSequence::new(&[7]);
    let task = NativeTask::new(env, tiles, Some(200), Pcg64::new(&seed));
    let rate = LearningRate::scheduled(Schedule::constant(0.5), 8);
    let agent = agent(8 * 4096 * 3, 3, rate, 1.0, (0.1, TieBreaking::First));
    let mut trainer = Trainer::new(task, TdLearner { agent, rule: Sarsa }, AgentRng::pcg64(&seed));
    trainer.advance(Budget { episodes: 10, work: WHOLE }).expect("tiles have no bounds");
    assert_eq!(table(&mut playground, 0), trainer.learner().agent.table.values());
}
