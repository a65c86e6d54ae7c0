//! Requests like those of the page, and properties that hold for all of them.

mod fourier;
mod maps;
mod parity;
mod refusals;
mod updates;

use serde_json::Value;

use crate::Playground;

/// The article's settings with a few episodes.
const ARTICLE: &str = r#"{"algorithm": "q_learning", "learning_rate": 0.2, "discount": 0.9,
    "learning_rate_schedule": "constant", "initial_q": [-1, 1], "terminal_update": "assign",
    "on_truncation": "bootstrap", "exploration": "epsilon_greedy", "epsilon": 0.8, "epsilon_schedule": "linear",
    "min_epsilon": 0, "epsilon_warm_up": 0, "ties": "first", "discretizer": "round", "scale": [10, 100],
    "episodes": 40, "max_episode_steps": 200, "bit_generator": "PCG64"}"#;

/// Settings of a table, with an algorithm and its options as JSON members.
fn of_table(algorithm: &str) -> String {
    format!(
        r#"{{"algorithm": {algorithm}, "learning_rate": 0.5, "discount": 0.9, "learning_rate_schedule": "constant",
        "initial_q": 0, "terminal_update": "target", "on_truncation": "bootstrap", "exploration": "epsilon_greedy",
        "epsilon": 0.3, "epsilon_schedule": "constant", "ties": "random", "discretizer": "identity", "episodes": 30,
        "max_episode_steps": 60, "bit_generator": "PCG64"}}"#
    )
}

/// Every algorithm with its options, as JSON members.
const ALGORITHMS: [&str; 10] = [
    r#""q_learning""#,
    r#""sarsa""#,
    r#""expected_sarsa""#,
    r#""double_q_learning""#,
    r#""n_step_sarsa", "n_steps": 3"#,
    r#""sarsa_lambda", "trace_decay": 0.8, "traces": "replacing", "trace_cutoff": 0"#,
    r#""true_online_sarsa_lambda", "trace_decay": 0.8, "trace_cutoff": 0.01"#,
    r#""watkins_q_lambda", "trace_decay": 0.8, "traces": "accumulating", "trace_cutoff": 0"#,
    r#""dyna_q", "planning_steps": 5"#,
    r#""dyna_q_plus", "planning_steps": 5, "time_weight": 0.01"#,
];

const MOUNTAIN_CAR: &str = r#"{"kind": "mountain_car"}"#;
const GRID: &str = r#"{"kind": "grid", "layout": ["S..#G", ".....", ".#..."], "wind": [0, 0, 1, 0, 0], "step_reward": -1,
    "goal_reward": 5, "rewards": [[2, 2, -3]]}"#;

/// The response to a request, which must be JSON.
fn call(playground: &mut Playground, request: &str) -> Value {
    let response = playground.call(request.as_bytes());
    serde_json::from_str(&response).unwrap_or_else(|_| unreachable!("the response is not JSON: {response}"))
}

fn start(playground: &mut Playground, environment: &str, settings: &str, seeds: &str) {
    let request =
        format!(r#"{{"call": "start", "environment": {environment}, "settings": {settings}, "seeds": {seeds}}}"#);
    assert_eq!(call(playground, &request).get("error"), None);
}

/// Starts a run of seed 1 whose first run watches a cell, given as `inspect` in JSON.
fn start_inspecting(playground: &mut Playground, environment: &str, settings: &str, inspect: &str) {
    let request = format!(
        r#"{{"call": "start", "environment": {environment}, "settings": {settings}, "seeds": [1], "inspect": {inspect}}}"#
    );
    assert_eq!(call(playground, &request).get("error"), None);
}

/// Trains to the end, with this much work per call.
fn finish(playground: &mut Playground, work: u32) {
    let request = format!(r#"{{"call": "advance", "work": {work}}}"#);
    while call(playground, &request).get("state").and_then(Value::as_str) == Some("training") {}
}

/// The action values of a run.
fn table(playground: &mut Playground, index: usize) -> Vec<f64> {
    call(playground, &format!(r#"{{"call": "table", "seed": {index}}}"#));
    playground.floats("table").expect("a table").to_vec()
}

/// Asks for the updates of a cell until they are found.
fn inspect(playground: &mut Playground, cell: usize) -> Value {
    loop {
        let inspected = call(playground, &format!(r#"{{"call": "inspect", "cell": {cell}, "work": 500}}"#));
        if inspected.get("state").is_none() {
            return inspected;
        }
    }
}
