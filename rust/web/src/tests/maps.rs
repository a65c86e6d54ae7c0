//! The values in a report, and the optimal or best known values to compare them with.

use std::f64::consts::PI;

use serde_json::Value;

use super::{ARTICLE, GRID, MOUNTAIN_CAR, call, finish, inspect, of_table, start, table};
use crate::Playground;

const BEST: &str = r#"{"call": "report", "map": true, "best": true}"#;

#[test]
fn two_tables_are_shown_on_the_scale_of_the_optimum() {
    let mut playground = Playground::default();
    start(&mut playground, GRID, &of_table(r#""double_q_learning""#), "[1]");
    finish(&mut playground, 100_000);
    let tables = table(&mut playground, 0);
    let (first, second) = tables.split_at(tables.len() / 2);
    let mean: Vec<f64> = first.iter().zip(second).map(|(one, other)| (one + other) / 2.0).collect();
    call(&mut playground, BEST);
    let shown = playground.floats("values").expect("a map");
    let is_wall = |cell: usize| cell == 3 || cell == 11;
    for (cell, (shown, mean)) in shown.iter().zip(mean.chunks(4)).enumerate() {
        let largest = mean.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        assert!(is_wall(cell) || *shown == largest, "{cell}");
    }
    inspect(&mut playground, 1);
    assert_eq!(playground.floats("actionValues"), Some(&mean[4..8]));
}

#[test]
fn values_of_two_tables_reach_the_optimum() {
    let corridor = r#"{"kind": "grid", "layout": ["S.G"], "step_reward": -1, "goal_reward": -1}"#;
    let settings = of_table(r#""double_q_learning""#).replace(r#""episodes": 30"#, r#""episodes": 400"#);
    let mut playground = Playground::default();
    start(&mut playground, corridor, &settings, "[1]");
    finish(&mut playground, 100_000);
    call(&mut playground, BEST);
    let (learned, best) = (playground.floats("values").expect("values"), playground.floats("bestValues"));
    assert_eq!(best.map(|best| &best[..2]), Some([-1.9, -1.0].as_slice()));
    assert!((learned[0] + 1.9).abs() < 1e-6 && (learned[1] + 1.0).abs() < 1e-6, "{learned:?}");
}

#[test]
fn the_best_known_values_of_mountain_car_need_its_time_limit() {
    for (limit, known) in [(199, false), (200, true), (1000, true)] {
        let settings = ARTICLE
            .replace(r#""max_episode_steps": 200"#, &format!(r#""max_episode_steps": {limit}"#))
            .replace(r#""discount": 0.9"#, r#""discount": 1"#);
        let mut playground = Playground::default();
        start(&mut playground, MOUNTAIN_CAR, &settings, "[0]");
        call(&mut playground, BEST);
        let values = playground.floats("bestValues");
        assert_eq!(values.is_some(), known, "{limit}");
        // The flag is reached from everywhere within 200 steps.
        assert!(values.unwrap_or_default().iter().all(|&value| value > -200.0));
    }
}

#[test]
fn the_map_of_the_taxi_shows_the_states_of_its_first_ride() {
    let mut playground = Playground::default();
    start(&mut playground, r#"{"kind": "taxi"}"#, &of_table(r#""q_learning""#), "[3]");
    finish(&mut playground, 100_000);
    let values = table(&mut playground, 0);
    let report = call(&mut playground, r#"{"call": "report", "map": true, "best": true, "episode": true}"#);
    assert_eq!(report.get("columns").and_then(Value::as_u64), Some(11));
    let first = playground.floats("observations").expect("an episode")[0] as usize;
    let (ride, square) = (first % 20, first / 20);
    let shown = playground.floats("values").expect("values").to_vec();
    let best = playground.floats("bestValues").expect("best values");
    for (cell, &shown) in shown.iter().enumerate() {
        let (row, column) = (cell / 11, cell % 11);
        let state = match column {
            5 => {
                assert!(shown.is_nan() && best[cell].is_nan());
                continue;
            }
            0..5 => (row * 5 + column) * 20 + ride,
            _ => (row * 5 + column - 6) * 20 + 16 + ride % 4,
        };
        let largest = values[state * 6..][..6].iter().copied().fold(f64::NEG_INFINITY, f64::max);
        assert_eq!(shown.to_bits(), largest.to_bits(), "{cell}");
    }
    assert!(shown[square / 5 * 11 + square % 5].is_finite());
}

#[test]
fn the_map_of_blackjack_shows_each_state_once() {
    let mut playground = Playground::default();
    start(&mut playground, r#"{"kind": "blackjack"}"#, &of_table(r#""sarsa""#), "[3]");
    finish(&mut playground, 100_000);
    let values = table(&mut playground, 0);
    let report = call(&mut playground, r#"{"call": "report", "map": true}"#);
    let size = ["rows", "columns"].map(|name| report.get(name).and_then(Value::as_u64));
    assert_eq!(size, [Some(18), Some(21)]);
    let shown = playground.floats("values").expect("values");
    for (cell, &shown) in shown.iter().enumerate() {
        let (sum, ace) = (21 - cell / 21, usize::from(cell % 21 > 10));
        if cell % 21 == 10 || (ace == 1 && sum < 12) {
            assert!(shown.is_nan(), "{cell}");
            continue;
        }
        let state = (sum * 11 + cell % 21 % 11 + 1) * 2 + ace;
        assert_eq!(shown.to_bits(), values[2 * state].max(values[2 * state + 1]).to_bits(), "{cell}");
    }
}

#[test]
fn the_map_of_acrobot_shows_its_angles() {
    let settings = of_table(r#""sarsa""#).replace(
        r#""discretizer": "identity""#,
        r#""discretizer": "tiles", "tilings": 4, "tiles": [2], "low": [-1, -1, -1, -1, -12.5, -28],
        "high": [1, 1, 1, 1, 12.5, 28]"#,
    );
    let map = r#"{"x": 0, "y": 2, "at": [0, 0, 0, 0, 0, 0], "columns": 8, "rows": 4}"#;
    let request = format!(
        r#"{{"call": "start", "environment": {{"kind": "acrobot"}}, "settings": {settings}, "seeds": [1], "map": {map}}}"#
    );
    let mut playground = Playground::default();
    assert_eq!(call(&mut playground, &request).get("error"), None);
    finish(&mut playground, 1_000_000);
    call(&mut playground, r#"{"call": "report", "map": true, "episode": true}"#);
    for name in ["xEdges", "yEdges"] {
        let edges = playground.floats(name).expect("edges");
        let ends = [edges[0], edges[edges.len() - 1]].map(f64::abs);
        assert_eq!(ends, [PI; 2], "{name}");
    }
    let values = playground.floats("values").expect("values").to_vec();
    assert_eq!(values.len(), 32);
    // The first cell of the second row: a column is an eighth of a circle wide, a row a quarter high.
    let [theta1, theta2] = [-7.0 / 8.0, 1.0 / 4.0].map(|half_circles: f64| half_circles * PI);
    inspect(&mut playground, 8);
    let observation = playground.floats("observation").expect("an observation");
    for (number, expected) in observation.iter().zip([theta1.cos(), theta1.sin(), theta2.cos(), theta2.sin(), 0.0, 0.0])
    {
        assert!((number - expected).abs() < 1e-15, "{observation:?}");
    }
    let largest = playground.floats("actionValues").expect("values").iter().copied().fold(f64::NEG_INFINITY, f64::max);
    assert_eq!(values[8].to_bits(), largest.to_bits());
}
