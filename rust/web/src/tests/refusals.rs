//! Every response is JSON, whatever the request: an error that names the setting, or a result.

use proptest::prelude::*;
use serde_json::Value;

use super::{ALGORITHMS, ARTICLE, GRID, MOUNTAIN_CAR, call, of_table, start};
use crate::Playground;

/// The error of a start with a member of the article's settings replaced.
fn error_of(member: &str, replacement: &str) -> (String, Option<String>) {
    assert!(ARTICLE.contains(member), "{member}");
    let settings = ARTICLE.replace(member, replacement);
    let request =
        format!(r#"{{"call": "start", "environment": {MOUNTAIN_CAR}, "settings": {settings}, "seeds": [0]}}"#);
    let response = call(&mut Playground::default(), &request);
    let text = |name: &str| response.get(name).and_then(Value::as_str).map(str::to_string);
    (text("error").expect("an error"), text("setting"))
}

#[test]
fn errors_name_the_setting_and_what_would_fit() {
    for (member, replacement, message) in [
        (r#""epsilon": 0.8"#, r#""epsilon": 2"#, "epsilon must be a number in [0, 1], got 2"),
        (r#""episodes": 40"#, r#""episodes": 0.5"#, "episodes must be an integer from 1 to 1000000, got 0.5"),
        (r#""scale": [10, 100]"#, r#""scale": [10]"#, "scale must be an array of 2 finite numbers, got an array of 1"),
        (r#""ties": "first""#, r#""ties": "last""#, "ties must be 'first' or 'random', got 'last'"),
        (r#""ties": "first","#, r"", "ties must be given"),
        (
            r#""exploration": "epsilon_greedy""#,
            r#""exploration": "ucb""#,
            "exploration must be 'epsilon_greedy' or 'softmax', got 'ucb'",
        ),
        (
            r#""algorithm": "q_learning""#,
            r#""algorithm": "monte_carlo""#,
            "algorithm must be 'q_learning' or 'sarsa' or 'expected_sarsa' or 'double_q_learning' or 'n_step_sarsa' or \
             'sarsa_lambda' or 'true_online_sarsa_lambda' or 'watkins_q_lambda' or 'dyna_q' or 'dyna_q_plus', got \
             'monte_carlo'",
        ),
        (r#""ties": "first""#, r#""ties": "first", "n_steps": 3"#, "n_steps does not apply to these settings"),
        (
            r#""initial_q": [-1, 1]"#,
            r#""initial_q": [1, -1]"#,
            "initial_q must be a finite number, or a range [low, high] of finite numbers, got an array of 2",
        ),
    ] {
        let (error, setting) = error_of(member, replacement);
        assert_eq!(error, message);
        assert_eq!(setting.as_deref(), message.split(' ').next());
    }
}

#[test]
fn what_is_not_json_is_refused() {
    for text in
        ["", "[", "[1,]", "nul", "1 2", "1e999", r#"{"a": +1}"#, r#"{"a": .5}"#, r#"{"a": 01}"#, "{\"a\": \"\u{1}\"}"]
    {
        let response = call(&mut Playground::default(), text);
        let error = response.get("error").and_then(Value::as_str).expect("an error");
        assert!(error.starts_with("the request must be JSON: "), "{text}: {error}");
    }
}

#[test]
fn the_map_of_a_lake_has_a_start_and_rows_of_one_length() {
    for (layout, message) in [
        (r"[]", "layout must hold 1 to 40 rows of one length, from 1 to 40 cells"),
        (r#"["SF", "G"]"#, "layout must hold 1 to 40 rows of one length, from 1 to 40 cells"),
        (r"[3]", "layout must hold texts"),
        (r#"["FG"]"#, ""),
        (r#"["SG"]"#, "no error"),
    ] {
        let settings = of_table(r#""sarsa""#);
        let request = format!(
            r#"{{"call": "start", "environment": {{"kind": "frozen_lake", "layout": {layout}}}, "settings": {settings}, "seeds": [0]}}"#
        );
        let response = call(&mut Playground::default(), &request);
        let error = response.get("error").and_then(Value::as_str).unwrap_or("no error");
        assert!(error.starts_with(message) && (error == "no error") == (message == "no error"), "{layout}: {error}");
    }
}

#[test]
fn tables_too_large_are_refused() {
    let (error, _) = error_of(r#""scale": [10, 100]"#, r#""scale": [1e300, 1e300]"#);
    assert_eq!(error, "scale must be such that the table has at most 16777216 rows, got an array of 2");
}

#[test]
fn runs_too_large_together_are_refused_before_they_are_made() {
    let bins = r#""discretizer": "bins", "bins": [2000, 2000]"#;
    for (algorithm, seeds, mib) in
        [(r#""q_learning""#, 16, 1740), (r#""dyna_q_plus", "planning_steps": 1, "time_weight": 0"#, 4, 3159)]
    {
        let settings = ARTICLE
            .replace(r#""discretizer": "round", "scale": [10, 100]"#, bins)
            .replace(r#""q_learning""#, algorithm);
        let seeds: Vec<String> = (0..seeds).map(|seed: u32| seed.to_string()).collect();
        let request = format!(
            r#"{{"call": "start", "environment": {MOUNTAIN_CAR}, "settings": {settings}, "seeds": [{}]}}"#,
            seeds.join(",")
        );
        let response = call(&mut Playground::default(), &request);
        let expected = format!(
            "{} runs with a table of 4000000 rows and 3 actions would take {mib} MiB, and the page has 512 MiB for them: choose fewer cells, or fewer seeds",
            seeds.len()
        );
        assert_eq!(response.get("error").and_then(Value::as_str), Some(expected.as_str()));
    }
}

#[test]
fn the_module_has_the_version_of_the_package() {
    let response = call(&mut Playground::default(), r#"{"call": "version"}"#);
    assert_eq!(response.get("version").and_then(Value::as_str), Some(env!("CARGO_PKG_VERSION")));
}

#[test]
fn calls_before_a_start_are_refused() {
    for name in ["advance", "step", "report", "inspect", "table"] {
        let response = call(&mut Playground::default(), &format!(r#"{{"call": "{name}"}}"#));
        assert_eq!(response.get("error").and_then(Value::as_str), Some("nothing was started"));
    }
}

/// Values to replace those of a request.
const STRANGE: [&str; 16] = [
    "null",
    "true",
    "-1",
    "0",
    "0.5",
    "1",
    "2",
    "7",
    "1e9",
    "1e308",
    "1e999",
    "\"\"",
    "\"q_learning\"",
    "[]",
    "[0.5, -3, 9]",
    "{\"a\": [1]}",
];
const CALLS: [&str; 8] = [
    r#"{"call": "advance", "work": 3000}"#,
    r#"{"call": "advance", "work": 3000, "episodes": 3}"#,
    r#"{"call": "step"}"#,
    r#"{"call": "report", "returns": true, "map": true, "episode": true, "best": true}"#,
    r#"{"call": "inspect", "cell": 7, "work": 3000}"#,
    r#"{"call": "inspect", "cell": 4000000000}"#,
    r#"{"call": "table", "seed": 1}"#,
    r#"{"call": "table", "seed": -1}"#,
];

/// The start and the end of each value in a request: after each colon, and in each array.
fn values_of(request: &str) -> Vec<(usize, usize)> {
    let starts = request.match_indices([':', '[', ',']).map(|(at, _)| at + 1);
    let end = |start: usize| request[start..].find([',', '}', ']']).map(|length| (start, start + length));
    starts.filter_map(end).filter(|(start, end)| start < end).collect()
}

proptest! {
    #[test]
    fn random_bytes_are_answered(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let response = Playground::default().call(&bytes);
        let response: Value = serde_json::from_str(&response).expect("JSON");
        prop_assert!(response.get("error").is_some());
    }

    #[test]
    fn damaged_requests_are_answered(
        algorithm in 0..ALGORITHMS.len(),
        on_grid in any::<bool>(),
        damages in prop::collection::vec((any::<prop::sample::Index>(), 0..STRANGE.len()), 0..4),
        calls in prop::collection::vec(0..CALLS.len(), 0..8),
    ) {
        let (environment, settings) =
            if on_grid { (GRID, of_table(ALGORITHMS[algorithm])) } else { (MOUNTAIN_CAR, ARTICLE.into()) };
        let mut request = format!(
            r#"{{"call": "start", "environment": {environment}, "settings": {settings}, "seeds": [3, 4], "map": {{"x": 0, "y": 1}}}}"#
        );
        for (place, strange) in damages {
            let values = values_of(&request);
            let (start, end) = *place.get(&values);
            request.replace_range(start..end, STRANGE[strange]);
        }
        let mut playground = Playground::default();
        call(&mut playground, &request);
        for index in calls {
            call(&mut playground, CALLS[index]);
        }
    }
}

#[test]
fn a_refused_request_leaves_nothing_behind() {
    let mut playground = Playground::default();
    start(&mut playground, MOUNTAIN_CAR, ARTICLE, "[0]");
    call(&mut playground, r#"{"call": "start"}"#);
    let response = call(&mut playground, r#"{"call": "advance"}"#);
    assert_eq!(response.get("error").and_then(Value::as_str), Some("nothing was started"));
}
