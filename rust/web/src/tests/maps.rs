//! The values in a report, and the optimal or best known values to compare them with.

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
