//! Runs with Fourier features: what they learn, what is shown of them, and what is refused.

use serde_json::Value;

use qtab_core::envs::classic_control::{CartPole, MountainCar};
use qtab_core::features::{ActiveFeatures, FeatureVector, Features, FourierBasis};
use qtab_core::learners::{
    Agent, DoubleQLearning, NStepSarsa, Sarsa, TdLearner, Traces, TrueOnlineSarsaLambda, UpdateRule,
};
use qtab_core::policies::TieBreaking;
use qtab_core::random::{AgentRng, Pcg64, SeedSequence};
use qtab_core::schedules::{LearningRate, Schedule};
use qtab_core::tasks::NativeTask;
use qtab_core::{Budget, Env, Learner, QTable, StopFlag, Trainer};

use super::parity::{agent, check_parts};
use super::updates::check_equation;
use super::{MOUNTAIN_CAR, call, finish, inspect, start, start_inspecting, table};
use crate::Playground;

/// The algorithms that learn with weighted features, with their options as JSON members.
const ALGORITHMS: [&str; 8] = [
    r#""q_learning""#,
    r#""sarsa""#,
    r#""expected_sarsa""#,
    r#""double_q_learning""#,
    r#""n_step_sarsa", "n_steps": 3"#,
    r#""sarsa_lambda", "trace_decay": 0.8, "traces": "accumulating", "trace_cutoff": 0"#,
    TRUE_ONLINE,
    r#""watkins_q_lambda", "trace_decay": 0.8, "traces": "accumulating", "trace_cutoff": 0.001"#,
];
const TRUE_ONLINE: &str = r#""true_online_sarsa_lambda", "trace_decay": 0.8, "trace_cutoff": 0"#;
const CART_POLE: &str = r#"{"kind": "cart_pole"}"#;

/// Settings with an algorithm and a discretizer, as JSON members.
fn settings(algorithm: &str, fourier: &str) -> String {
    format!(
        r#"{{"algorithm": {algorithm}, "learning_rate": 0.01, "discount": 0.9, "learning_rate_schedule": "linear",
        "min_learning_rate": 0.001, "learning_rate_warm_up": 2, "initial_q": 0, "terminal_update": "target",
        "on_truncation": "bootstrap", "exploration": "epsilon_greedy", "epsilon": 0.2, "epsilon_schedule": "constant",
        "ties": "first", "discretizer": "fourier", {fourier}, "episodes": 12, "max_episode_steps": 200,
        "bit_generator": "PCG64"}}"#
    )
}

const SCALED: &str = r#""order": 5, "coupled": true, "scale_step_sizes": true"#;

/// The table that the core learns with these settings, put together by hand.
fn learned<E, const M: usize, U>(
    env: E,
    basis: FourierBasis<f32, 256>,
    rule: impl Fn(&Agent) -> U,
    limit: u64,
) -> Vec<f64>
where
    E: Env<Action = usize, Observation = [f32; M]>,
    U: UpdateRule<FeatureVector<256>, Agent>,
{
    let (rows, num_actions) = (basis.n_features(), env.num_actions());
    let schedule = Schedule::linear(0.01, 0.001, 12, 2);
    let divisors = basis.divisors();
    let rate = if divisors.is_empty() {
        LearningRate::scheduled(schedule, 1)
    } else {
        LearningRate::scaled_by_row(schedule, divisors)
    };
    let agent = agent(rows * num_actions, num_actions, rate, 0.9, (0.2, TieBreaking::First));
    let seed = SeedSequence::new(&[4]);
    let task = NativeTask::new(env, basis, Some(limit), Pcg64::new(&seed));
    let rule = rule(&agent);
    let mut trainer = Trainer::new(task, TdLearner { agent, rule }, AgentRng::pcg64(&seed));
    trainer.advance(Budget { episodes: 12, work: u64::MAX }).expect("observations are numbers");
    Learner::<FeatureVector<256>>::tables(trainer.learner()).concat()
}

#[test]
fn the_weights_are_those_of_the_core() {
    let car = |order, coupled, scaled| {
        FourierBasis::try_new(
            &[-1.2_f32, -0.07].map(f64::from),
            &[0.6_f32, 0.07].map(f64::from),
            order,
            coupled,
            scaled,
        )
        .expect("a basis")
    };
    let mut playground = Playground::default();
    let mut found = |environment: &str, settings: &str| {
        start(&mut playground, environment, settings, "[4]");
        finish(&mut playground, 3000);
        let found = table(&mut playground, 0);
        assert!(found.iter().filter(|weight| **weight != 0.0).count() > 20);
        found
    };
    let expected = learned(MountainCar::default(), car(5, true, true), |_| Sarsa, 200);
    assert_eq!(found(MOUNTAIN_CAR, &settings(r#""sarsa""#, SCALED)), expected);

    let true_online = |_: &Agent| {
        TrueOnlineSarsaLambda::new(Traces::new(0, 0.0, &StopFlag::new()).expect("traces of 0 take no memory"), 0.8)
    };
    let expected = learned(MountainCar::default(), car(5, true, true), true_online, 200);
    assert_eq!(found(MOUNTAIN_CAR, &settings(TRUE_ONLINE, SCALED)), expected);

    let double = |agent: &Agent| DoubleQLearning::new(agent.learning_rate.clone(), agent.table.clone());
    let expected = learned(MountainCar::default(), car(9, false, false), double, 200);
    let uncoupled = r#""order": 9, "coupled": false, "scale_step_sizes": false"#;
    assert_eq!(found(MOUNTAIN_CAR, &settings(r#""double_q_learning""#, uncoupled)), expected);

    let limits = [2.4, 2.5, 0.21, 3.5];
    let basis = FourierBasis::try_new(&limits.map(|limit| -limit), &limits, 2, true, true).expect("a basis");
    let expected = learned(CartPole::default(), basis, |_| NStepSarsa::new(3), 200);
    let limited = r#""order": 2, "coupled": true, "scale_step_sizes": true, "low": [-2.4, -2.5, -0.21, -3.5],
        "high": [2.4, 2.5, 0.21, 3.5]"#;
    assert_eq!(found(CART_POLE, &settings(r#""n_step_sarsa", "n_steps": 3"#, limited)), expected);
}

#[test]
fn steps_slices_and_inspections_change_nothing() {
    for algorithm in ALGORITHMS {
        check_parts(MOUNTAIN_CAR, &settings(algorithm, SCALED), 1128);
    }
}

#[test]
fn the_map_shows_the_values_and_the_visits_of_its_cells() {
    let mut playground = Playground::default();
    start(&mut playground, MOUNTAIN_CAR, &settings(r#""sarsa""#, SCALED), "[1]");
    finish(&mut playground, 100_000);
    let weights = table(&mut playground, 0);
    let report = call(&mut playground, r#"{"call": "report", "map": true, "returns": true}"#);
    let steps = -playground.floats("returns").expect("returns").iter().sum::<f64>();
    let visits = playground.floats("visits").expect("visits").to_vec();
    assert_eq!(visits.iter().sum::<f64>(), steps);
    assert!(visits.iter().filter(|visits| **visits > 0.0).count() > 50, "{report:?}");
    let values = playground.floats("values").expect("values").to_vec();
    let basis: FourierBasis<f32, 36> =
        FourierBasis::try_new(&[-1.2_f32, -0.07].map(f64::from), &[0.6_f32, 0.07].map(f64::from), 5, true, true)
            .expect("a basis");
    for cell in [0, 777, 2303] {
        inspect(&mut playground, cell);
        let observation = playground.floats("observation").expect("an observation");
        let features = basis.active_rows(&[observation[0] as f32, observation[1] as f32]).expect("numbers");
        let mut q = QTable::<0>::new(weights.clone(), 3);
        let expected = q.action_values(&features).to_vec();
        assert_eq!(features.values().len(), 36);
        assert_eq!(playground.floats("actionValues"), Some(&expected[..]));
        assert_eq!(values[cell], expected.into_iter().fold(f64::NEG_INFINITY, f64::max));
        let counts: f64 = playground.floats("visits").expect("visits").iter().sum();
        assert_eq!(counts, visits[cell]);
    }
}

#[test]
fn every_equation_holds() {
    for algorithm in ALGORITHMS {
        for fourier in [SCALED, r#""order": 5, "coupled": true, "scale_step_sizes": false"#] {
            let mut playground = Playground::default();
            start(&mut playground, MOUNTAIN_CAR, &settings(algorithm, fourier), "[1]");
            finish(&mut playground, 1_000_000);
            call(&mut playground, r#"{"call": "report", "map": true}"#);
            let visits = playground.floats("visits").expect("visits").to_vec();
            let cell = (0..visits.len()).fold(0, |best, cell| if visits[cell] > visits[best] { cell } else { best });
            let inspected = inspect(&mut playground, cell);
            let updates = inspected.get("updates").and_then(Value::as_array).expect("updates").clone();
            assert_eq!(updates.len(), (visits[cell] as usize).min(8), "{algorithm}");
            for update in &updates {
                check_equation(update, 0.9, false, algorithm);
            }
            // A run that watches the cell from its start finds the same updates.
            let mut watched = Playground::default();
            let inspect = format!(r#"{{"cell": {cell}, "columns": 48, "rows": 48}}"#);
            start_inspecting(&mut watched, MOUNTAIN_CAR, &settings(algorithm, fourier), &inspect);
            finish(&mut watched, 1000);
            assert_eq!(super::inspect(&mut watched, cell).get("updates"), Some(&Value::Array(updates)), "{algorithm}");
        }
    }
}

#[test]
fn what_has_no_meaning_is_refused_in_words() {
    let sarsa = settings(r#""sarsa""#, SCALED);
    for (environment, member, replacement, message) in [
        (
            MOUNTAIN_CAR,
            r#""order": 5"#,
            r#""order": 16"#,
            "order must be small enough for 256 features with 2 components, got 16",
        ),
        (MOUNTAIN_CAR, r#""order": 5"#, r#""order": 0"#, "order must be an integer from 1 to 256, got 0"),
        (MOUNTAIN_CAR, r#""coupled": true"#, r#""coupled": 1"#, "coupled must be true or false, got 1"),
        (
            MOUNTAIN_CAR,
            r#""algorithm": "sarsa""#,
            r#""algorithm": "dyna_q", "planning_steps": 1"#,
            "algorithm must be one that learns with weighted features for discretizer 'fourier', got 'dyna_q'",
        ),
        (
            MOUNTAIN_CAR,
            r#""algorithm": "sarsa""#,
            r#""algorithm": "sarsa_lambda", "trace_decay": 0.9, "traces": "replacing", "trace_cutoff": 0"#,
            "traces must be 'accumulating' for discretizer 'fourier', got 'replacing'",
        ),
        (
            MOUNTAIN_CAR,
            r#""discretizer": "fourier""#,
            r#""discretizer": "polynomial""#,
            "discretizer must be 'round' or 'bins' or 'tiles' or 'fourier', got 'polynomial'",
        ),
        (
            MOUNTAIN_CAR,
            r#""terminal_update": "target""#,
            r#""terminal_update": "assign""#,
            "terminal_update must be 'target' for this algorithm and discretizer, got 'assign'",
        ),
        (
            MOUNTAIN_CAR,
            r#""learning_rate_schedule": "linear",
        "min_learning_rate": 0.001, "learning_rate_warm_up": 2"#,
            r#""learning_rate_schedule": "visits", "min_learning_rate": 0"#,
            "learning_rate_schedule must be 'constant', 'linear' or 'exponential' for this discretizer, got 'visits'",
        ),
        (
            CART_POLE,
            r#""order": 5"#,
            r#""order": 1"#,
            "low must be given with high, as the observation space has no bounds, got nothing",
        ),
        (MOUNTAIN_CAR, r#""order": 5"#, r#""order": 5, "tilings": 8"#, "tilings does not apply to these settings"),
    ] {
        assert!(sarsa.contains(member), "{member}");
        let changed = sarsa.replace(member, replacement);
        let request =
            format!(r#"{{"call": "start", "environment": {environment}, "settings": {changed}, "seeds": [0]}}"#);
        let response = call(&mut Playground::default(), &request);
        assert_eq!(response.get("error").and_then(Value::as_str), Some(message));
    }
}
