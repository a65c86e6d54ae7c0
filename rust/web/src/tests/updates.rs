//! The updates of an inspection are those that were made, and their numbers are consistent.

use serde_json::Value;

use super::{ALGORITHMS, ARTICLE, GRID, MOUNTAIN_CAR, call, finish, inspect, of_table, start, start_inspecting, table};
use crate::Playground;

/// Changes of settings that affect updates, as JSON members and their replacements.
const VARIANTS: [&[(&str, &str)]; 5] = [
    &[],
    &[(r#""on_truncation": "bootstrap""#, r#""on_truncation": "terminate""#)],
    &[(r#""learning_rate_schedule": "constant""#, r#""learning_rate_schedule": "visits", "min_learning_rate": 0.1"#)],
    &[(
        r#""learning_rate_schedule": "constant""#,
        r#""learning_rate_schedule": "linear", "min_learning_rate": 0.1, "learning_rate_warm_up": 3"#,
    )],
    &[(r#""exploration": "epsilon_greedy""#, r#""exploration": "softmax", "temperature": 0.7"#)],
];
/// Settings of epsilon-greedy, which do not apply to softmax.
const OF_EPSILON: [&str; 3] = [r#""epsilon": 0.3,"#, r#""epsilon_schedule": "constant","#, r#""ties": "random","#];

fn number(update: &Value, name: &str) -> Option<f64> {
    update.get(name).and_then(Value::as_f64)
}

fn text<'a>(update: &'a Value, name: &str) -> &'a str {
    update.get(name).and_then(Value::as_str).expect("a text")
}

/// Whether two numbers agree up to rounding.
fn close(left: f64, right: f64) -> bool {
    (left - right).abs() <= 1e-9 * left.abs().max(right.abs()).max(1.0)
}

/// The settings with parts replaced; `None` where the algorithm does not allow that.
fn changed(settings: &str, changes: &[(&str, &str)]) -> Option<String> {
    let mut result = settings.to_string();
    for (member, replacement) in changes {
        assert!(result.contains(member), "{member}");
        result = result.replace(member, replacement);
        if replacement.contains("softmax") {
            for member in OF_EPSILON {
                result = result.replace(member, "");
            }
        }
    }
    let refused = result.contains("visits") && result.contains("true_online");
    (!refused).then_some(result)
}

/// Checks the equation of an update. It holds to the last bit with a single active row and without traces.
pub(super) fn check_equation(update: &Value, discount: f64, exact: bool, context: &str) {
    let agree = |left: f64, right: f64| if exact { left.to_bits() == right.to_bits() } else { close(left, right) };
    let value = |name: &str| number(update, name).expect("a number");
    let (old, new, target) = (value("old"), value("new"), value("target"));
    let (kind, end) = (text(update, "kind"), text(update, "end"));
    let context = format!("{context}: {update:?}");
    let expected = match (kind, number(update, "learningRate")) {
        (_, None) => target,
        ("trace", Some(rate)) => old + rate * value("trace") * (target - old),
        ("dutch_trace", Some(rate)) => {
            old + rate * value("trace") * (target - value("qOld")) - rate * (old - value("qOld"))
        }
        (_, Some(rate)) => old + rate * (target - old),
    };
    assert!(agree(new, expected), "{context}");
    if matches!(kind, "n_step" | "planning") {
        assert_eq!((end, number(update, "reward")), ("other", None), "{context}");
        return;
    }
    let ended = matches!(end, "terminal" | "truncated_as_terminal");
    assert_eq!(number(update, "nextValue").is_none(), ended, "{context}");
    let following = number(update, "nextValue").map_or(0.0, |next| discount * next);
    assert_eq!(target.to_bits(), (value("reward") + following).to_bits(), "{context}");
}

/// Checks that each update of a value starts from the result of the previous one, and that the last one matches the
/// table.
fn check_that_none_is_missing(updates: &[Value], tables: &[f64], (cell, num_actions): (usize, usize), context: &str) {
    let size = tables.len() / if context.contains("double") { 2 } else { 1 };
    let integer = |update: &Value, name: &str| update.get(name).and_then(Value::as_u64).expect("an integer");
    for (index, update) in updates.iter().enumerate() {
        let place = (integer(update, "table"), integer(update, "action"));
        let later =
            updates[index + 1..].iter().find(|later| (integer(later, "table"), integer(later, "action")) == place);
        let after = later.map_or_else(
            || tables[place.0 as usize * size + cell * num_actions + place.1 as usize],
            |later| number(later, "old").expect("old"),
        );
        assert_eq!(number(update, "new"), Some(after), "{context}: {updates:?}");
    }
}

#[test]
fn every_equation_of_a_table_holds() {
    for algorithm in ALGORITHMS {
        let (mut seen, mut cut) = (0, 0);
        for changes in VARIANTS {
            let settings = of_table(algorithm).replace(r#""max_episode_steps": 60"#, r#""max_episode_steps": 7"#);
            let Some(settings) = changed(&settings, changes) else { continue };
            let mut playground = Playground::default();
            start(&mut playground, GRID, &settings, "[1]");
            finish(&mut playground, 100_000);
            let learned = table(&mut playground, 0);
            for cell in [0, 1, 6, 7, 8] {
                let context = format!("{algorithm} with {changes:?}, cell {cell}");
                let inspected = inspect(&mut playground, cell);
                let updates = inspected.get("updates").and_then(Value::as_array).expect("updates");
                let traces = algorithm.contains("lambda");
                for update in updates {
                    check_equation(update, 0.9, !traces, &context);
                    seen += 1;
                    let end = text(update, "end");
                    let terminates = settings.contains("terminate");
                    assert_ne!(end, if terminates { "truncated" } else { "truncated_as_terminal" }, "{context}");
                    cut += usize::from(end.starts_with("truncated"));
                }
                if !traces {
                    check_that_none_is_missing(updates, &learned, (cell, 4), &context);
                }
            }
        }
        assert!(seen > 100, "{algorithm}: {seen}");
        assert!(cut > 0 || algorithm.contains("n_step"), "{algorithm}: no time limit was seen");
    }
}

#[test]
fn a_value_that_is_assigned_has_no_learning_rate() {
    for algorithm in ALGORITHMS {
        let settings = of_table(algorithm).replace(r#""terminal_update": "target""#, r#""terminal_update": "assign""#);
        let mut playground = Playground::default();
        if algorithm.contains("lambda") || algorithm.contains("n_step") {
            continue;
        }
        start(&mut playground, r#"{"kind": "grid", "layout": ["SG."]}"#, &settings, "[1]");
        finish(&mut playground, 100_000);
        let inspected = inspect(&mut playground, 0);
        let updates = inspected.get("updates").and_then(Value::as_array).expect("updates");
        let mut assigned = 0;
        for update in updates {
            check_equation(update, 0.9, true, algorithm);
            assigned += usize::from(number(update, "learningRate").is_none());
        }
        assert!(assigned > 0, "{algorithm}: {updates:?}");
        check_that_none_is_missing(updates, &table(&mut playground, 0), (0, 4), algorithm);
    }
}

#[test]
fn every_equation_of_tile_coding_holds() {
    let tiles = ARTICLE
        .replace(r#""discretizer": "round", "scale": [10, 100]"#, r#""discretizer": "tiles", "tilings": 8, "tiles": 4"#)
        .replace(r#""terminal_update": "assign""#, r#""terminal_update": "target""#)
        .replace(r#""epsilon_schedule": "linear","#, r#""epsilon_schedule": "constant","#)
        .replace(r#""min_epsilon": 0, "epsilon_warm_up": 0,"#, "");
    for algorithm in ALGORITHMS.iter().filter(|algorithm| !algorithm.contains("dyna")) {
        let settings = tiles.replace(r#""q_learning""#, algorithm);
        for changes in &VARIANTS[..3] {
            let Some(settings) = changed(&settings, changes) else { continue };
            let mut playground = Playground::default();
            start(&mut playground, MOUNTAIN_CAR, &settings, "[1]");
            finish(&mut playground, 1_000_000);
            let inspected = call(&mut playground, r#"{"call": "inspect", "cell": 1128, "work": 1000000}"#);
            let updates = inspected.get("updates").and_then(Value::as_array).expect("updates");
            assert_eq!(updates.len(), 8, "{algorithm}");
            for update in updates {
                check_equation(update, 0.9, false, algorithm);
            }
        }
    }
}

#[test]
fn the_last_update_left_the_value_that_the_state_has() {
    let mut playground = Playground::default();
    start(&mut playground, MOUNTAIN_CAR, ARTICLE, "[0]");
    finish(&mut playground, 100_000);
    let mut checked = 0;
    for cell in 0..285 {
        let inspected = inspect(&mut playground, cell);
        let values = playground.floats("actionValues").expect("action values").to_vec();
        let updates = inspected.get("updates").and_then(Value::as_array).expect("updates");
        for (action, &value) in values.iter().enumerate() {
            let of_action = |update: &&Value| update.get("action").and_then(Value::as_u64) == Some(action as u64);
            if let Some(last) = updates.iter().rfind(of_action) {
                assert_eq!(number(last, "new"), Some(value));
                checked += 1;
            }
        }
    }
    assert!(checked > 50, "{checked}");
}

#[test]
fn a_state_that_was_watched_from_the_start_needs_no_second_run() {
    for algorithm in ALGORITHMS {
        let settings = of_table(algorithm).replace(r#""episodes": 30"#, r#""episodes": 400"#);
        let mut repeated = Playground::default();
        start(&mut repeated, GRID, &settings, "[1]");
        finish(&mut repeated, 100_000);
        let first = call(&mut repeated, r#"{"call": "inspect", "cell": 0, "work": 0}"#);
        assert!(first.get("updates").is_some(), "the start of an episode is watched");
        let expected = inspect(&mut repeated, 7);

        let mut watched = Playground::default();
        start_inspecting(&mut watched, GRID, &settings, r#"{"cell": 7, "columns": 5, "rows": 3}"#);
        finish(&mut watched, 1000);
        let found = call(&mut watched, r#"{"call": "inspect", "cell": 7, "work": 0}"#);
        assert_eq!(found.get("updates"), expected.get("updates"), "{algorithm}");

        let mut of_another_map = Playground::default();
        start_inspecting(&mut of_another_map, GRID, &settings, r#"{"cell": 7, "columns": 5, "rows": 4}"#);
        finish(&mut of_another_map, 100_000);
        let found = call(&mut of_another_map, r#"{"call": "inspect", "cell": 0, "work": 0}"#);
        assert_eq!(found.get("updates"), first.get("updates"), "{algorithm}");
    }
}

#[test]
fn planning_is_shown_update_by_update() {
    let corridor = r#"{"kind": "grid", "layout": ["S.G"], "step_reward": -1, "goal_reward": 5}"#;
    let settings = of_table(r#""dyna_q", "planning_steps": 20000"#);
    let mut playground = Playground::default();
    start(&mut playground, corridor, &settings, "[1]");
    for step in 1..5 {
        call(&mut playground, r#"{"call": "step"}"#);
        let report = call(&mut playground, r#"{"call": "report"}"#);
        let Some(current) = report.get("current") else { continue };
        assert_eq!(current.get("step").and_then(Value::as_u64), Some(step));
        assert!(current.get("nextAction").and_then(Value::as_u64).is_some(), "{current:?}");
    }
    let learned = table(&mut playground, 0);
    for cell in 0..2 {
        let inspected = inspect(&mut playground, cell);
        let updates = inspected.get("updates").and_then(Value::as_array).expect("updates");
        assert!(updates.iter().any(|update| text(update, "kind") == "planning"));
        for update in updates {
            check_equation(update, 0.9, true, "dyna_q");
        }
        check_that_none_is_missing(updates, &learned, (cell, 4), "dyna_q");
    }
}

#[test]
fn a_step_in_parts_is_shown_update_by_update() {
    // No path leads to the goal: the agent learns from all steps when the time limit ends the episode.
    let enclosed = r#"{"kind": "grid", "layout": ["S.#G"], "step_reward": -1, "goal_reward": 5}"#;
    let settings = of_table(r#""n_step_sarsa", "n_steps": 3000"#).replace(": 60", ": 3000").replace(": 30", ": 1");
    let mut playground = Playground::default();
    start(&mut playground, enclosed, &settings, "[1]");
    finish(&mut playground, 1000);
    let learned = table(&mut playground, 0);
    for cell in 0..2 {
        let inspected = inspect(&mut playground, cell);
        let updates = inspected.get("updates").and_then(Value::as_array).expect("updates");
        assert!(updates.iter().any(|update| text(update, "kind") == "n_step"));
        for update in updates {
            check_equation(update, 0.9, true, "n_step_sarsa");
        }
        check_that_none_is_missing(updates, &learned, (cell, 4), "n_step_sarsa");
    }
}

#[test]
fn a_paused_episode_is_reported_with_its_next_action() {
    let mut playground = Playground::default();
    start(&mut playground, GRID, &of_table(r#""sarsa""#), "[1]");
    for step in 1..4 {
        call(&mut playground, r#"{"call": "step"}"#);
        let report = call(&mut playground, r#"{"call": "report"}"#);
        let current = report.get("current").expect("an episode");
        assert_eq!(current.get("step").and_then(Value::as_u64), Some(step));
        assert!(current.get("nextAction").and_then(Value::as_u64).is_some());
    }
}
