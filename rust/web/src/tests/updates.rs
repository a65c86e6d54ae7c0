//! The updates that an inspection shows are those that were made.

use super::{ALGORITHMS, ARTICLE, GRID, MOUNTAIN_CAR, call, finish, inspect, of_table, start};
use crate::Playground;
use crate::json::Json;

fn number(update: &Json, name: &str) -> Option<f64> {
    update.get(name).and_then(Json::number)
}

/// Whether two numbers agree but for rounding.
fn close(left: f64, right: f64) -> bool {
    (left - right).abs() <= 1e-9 * left.abs().max(right.abs()).max(1.0)
}

#[test]
fn the_numbers_of_an_update_fit_together() {
    for algorithm in ALGORITHMS {
        let mut playground = Playground::default();
        start(&mut playground, GRID, &of_table(algorithm), "[1]");
        finish(&mut playground, 100_000);
        let mut seen = 0;
        for cell in [0, 1, 6, 7, 8] {
            let inspected = inspect(&mut playground, cell);
            for update in inspected.get("updates").and_then(Json::array).expect("updates") {
                let kind = update.get("kind").and_then(Json::text).expect("a kind");
                let (old, new) = (number(update, "old").expect("old"), number(update, "new").expect("new"));
                let rate = number(update, "learningRate").expect("a learning rate");
                if let Some(target) = number(update, "target") {
                    if kind != "trace" {
                        assert!(close(new, old + rate * (target - old)), "{algorithm}: {update:?}");
                    }
                    if let (Some(reward), Some(next)) = (number(update, "reward"), number(update, "nextValue")) {
                        assert!(close(target, reward + 0.9 * next), "{algorithm}: {update:?}");
                    }
                }
                seen += 1;
            }
        }
        assert!(seen > 10, "{algorithm}: {seen}");
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
        let updates = inspected.get("updates").and_then(Json::array).expect("updates");
        for (action, &value) in values.iter().enumerate() {
            let of_action = |update: &&Json| update.get("action").and_then(|a| a.integer(2)) == Some(action as u32);
            if let Some(last) = updates.iter().rfind(of_action) {
                assert_eq!(number(last, "new"), Some(value));
                checked += 1;
            }
        }
    }
    assert!(checked > 50, "{checked}");
}

#[test]
fn a_paused_episode_is_reported_with_its_next_action() {
    let mut playground = Playground::default();
    start(&mut playground, GRID, &of_table(r#""sarsa""#), "[1]");
    for step in 1..4 {
        call(&mut playground, r#"{"call": "step"}"#);
        let report = call(&mut playground, r#"{"call": "report"}"#);
        let current = report.get("current").expect("an episode");
        assert_eq!(current.get("step").and_then(|steps| steps.integer(9)), Some(step));
        assert!(current.get("action").and_then(|action| action.integer(3)).is_some());
    }
}
