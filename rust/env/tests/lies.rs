//! Tables and functions that break the rules of the interface are told.

#![expect(unsafe_code, reason = "these are the functions of a library")]

mod support;

use std::ffi::c_void;
use std::ptr;
use std::sync::atomic::{AtomicI64, Ordering};

use qtab_env::host::{CallError, Environment, Episode, RandomBits, TableError, TrialError, try_out};
use qtab_env::{Bitgen, FAILED, FLOAT32, Table};
use support::{SplitMix, Walk, table, walk};

/// The environment of a table.
fn checked(table: &Table) -> Result<Environment, TableError> {
    // SAFETY: the table is a `qtab_env`, and its functions write at most a guard too much.
    unsafe { Environment::new(table) }
}

fn tried(table: &Table) -> Result<(), TrialError> {
    try_out(&checked(table).expect("the sizes are valid"), 200, &mut SplitMix(0))
}

#[test]
fn an_environment_that_keeps_the_rules_passes() {
    assert_eq!(tried(&walk()), Ok(()));
}

#[test]
fn wrong_numbers_are_told_by_the_name_of_their_field() {
    let right = walk();
    let infinite = [f64::INFINITY];
    let wrong: [(&str, Table); 15] = [
        ("struct_size", Table { struct_size: 8, ..right }),
        ("struct_size", Table { struct_size: 4096, ..right }),
        ("state_size", Table { state_size: u64::MAX, ..right }),
        ("observation_type", Table { observation_type: 3, ..right }),
        ("observation_size", Table { observation_size: 0, ..right }),
        ("observation_size", Table { observation_size: u32::MAX, ..right }),
        ("num_actions", Table { num_actions: 0, ..right }),
        ("num_actions", Table { num_actions: i64::MIN, ..right }),
        ("num_actions", Table { num_actions: i64::MAX, ..right }),
        ("max_episode_steps", Table { max_episode_steps: -1, ..right }),
        ("has_action_mask", Table { has_action_mask: 2, ..right }),
        ("reserved", Table { reserved: 1, ..right }),
        ("observation_low", Table { observation_low: ptr::null(), ..right }),
        (
            "observation_low",
            Table { observation_low: right.observation_high, observation_high: right.observation_low, ..right },
        ),
        ("observation_high", Table { observation_high: infinite.as_ptr(), ..right }),
    ];
    for (field, table) in &wrong {
        match checked(table) {
            Err(TableError::Field { name, .. }) => assert_eq!(name, *field),
            other => unreachable!("{field} is wrong, but the check gave {other:?}"),
        }
    }
    for (field, table) in [
        ("reset", Table { reset: None, ..right }),
        ("step", Table { step: None, ..right }),
        ("observe", Table { observe: None, ..right }),
    ] {
        let expected = format!("its {field} must be a function, got NULL");
        assert_eq!(checked(&table).expect_err("a function is missing").to_string(), expected);
    }
    let newer = Table { version: 2, ..right };
    assert_eq!(checked(&newer).expect_err("another version"), TableError::Version(2));
    // SAFETY: null is allowed.
    assert_eq!(unsafe { Environment::new(ptr::null()) }.expect_err("no table"), TableError::Null);
}

#[test]
fn bounds_of_float32_are_rounded_as_the_space_rounds_them() {
    let (low, high) = ([0.1], [0.6]);
    let right =
        Table { observation_type: FLOAT32, observation_low: low.as_ptr(), observation_high: high.as_ptr(), ..walk() };
    let environment = checked(&right).expect("valid bounds");
    assert_eq!((environment.low(0), environment.high(0)), (f64::from(0.1_f32), f64::from(0.6_f32)));
}

#[test]
fn a_panic_is_a_failure_and_leaves_the_state() {
    let environment = checked(&table(Walk { panics_at: Some(3) })).expect("valid sizes");
    let mut episode = Episode::new(&environment).expect("memory suffices");
    let mut rng = SplitMix(1);
    episode.reset(&mut RandomBits::new(&mut rng)).expect("a reset");
    episode.set_state(&3_i64.to_ne_bytes());
    episode.observe().expect("an observation");
    assert_eq!(episode.observation::<i64>(), [3]);
    assert_eq!(episode.action_mask(), [0, 1]);
    assert_eq!(episode.step(1, &mut RandomBits::new(&mut rng)), Err(CallError::Failed));
    assert_eq!(episode.state(), 3_i64.to_ne_bytes());
}

/// A lie of `step`.
type Lie = unsafe extern "C" fn(
    *const c_void,
    *const Bitgen,
    *const c_void,
    i64,
    *mut c_void,
    *mut c_void,
    *mut f64,
    *mut u8,
) -> i32;

/// Defines a function `step` that does the usual, and then something else.
macro_rules! lie {
    ($name:ident, |$state:ident, $next:ident, $observation:ident, $reward:ident, $mask:ident| $then:expr) => {
        #[allow(unused_unsafe, reason = "some only return another code")]
        unsafe extern "C" fn $name(
            parameters: *const c_void,
            rng: *const Bitgen,
            $state: *const c_void,
            action: i64,
            $next: *mut c_void,
            $observation: *mut c_void,
            $reward: *mut f64,
            $mask: *mut u8,
        ) -> i32 {
            let step = walk().step.expect("the walk has it");
            // SAFETY: the arguments are those of the caller.
            let code = unsafe { step(parameters, rng, $state, action, $next, $observation, $reward, $mask) };
            // SAFETY: the writes end within the guard of a buffer.
            let changed: Option<i32> = unsafe { $then };
            changed.unwrap_or(code)
        }
    };
}

lie!(beyond_the_state, |_state, next, _observation, _reward, _mask| {
    next.cast::<u8>().add(8).write(0);
    None
});
lie!(beyond_the_observation, |_state, _next, observation, _reward, _mask| {
    observation.cast::<i64>().add(1).write(0);
    None
});
lie!(beyond_the_mask, |_state, _next, _observation, _reward, mask| {
    mask.add(2).write(1);
    None
});
lie!(into_the_state, |state, _next, _observation, _reward, _mask| {
    state.cast_mut().cast::<i64>().write(3);
    None
});
lie!(outside_the_bounds, |_state, _next, observation, _reward, _mask| {
    observation.cast::<i64>().write(7);
    None
});
lie!(no_action, |_state, _next, _observation, _reward, mask| {
    mask.write_bytes(0, 2);
    None
});
lie!(another_mask, |_state, _next, _observation, _reward, mask| {
    mask.write_bytes(1, 2);
    None
});
lie!(no_boolean, |_state, _next, _observation, _reward, mask| {
    mask.write(7);
    None
});
lie!(no_reward, |_state, _next, _observation, reward, _mask| {
    reward.write(f64::NAN);
    None
});
lie!(no_code, |_state, _next, _observation, _reward, _mask| Some(17));
lie!(failing, |_state, _next, _observation, _reward, _mask| Some(FAILED));

static CALLS: AtomicI64 = AtomicI64::new(0);
lie!(remembering, |_state, _next, _observation, reward, _mask| {
    reward.write(CALLS.fetch_add(1, Ordering::Relaxed) as f64);
    None
});

#[test]
fn functions_that_lie_are_told() {
    let error = |lie: Lie| tried(&Table { step: Some(lie), ..walk() }).expect_err("a lie");
    assert_eq!(error(beyond_the_state), TrialError::Overrun("state"));
    assert_eq!(error(beyond_the_observation), TrialError::Overrun("observation"));
    assert_eq!(error(beyond_the_mask), TrialError::Overrun("action_mask"));
    assert_eq!(error(into_the_state), TrialError::StateChanged);
    let outside = TrialError::Observation { function: "step", index: 0, value: 7.0, bounds: (0.0, 6.0) };
    assert_eq!(error(outside_the_bounds), outside);
    assert_eq!(error(no_action), TrialError::ActionMask { function: "step", mask: vec![0, 0] });
    assert_eq!(error(another_mask), TrialError::Observe("action mask"));
    assert!(matches!(error(no_boolean), TrialError::ActionMask { function: "step", .. }));
    assert!(matches!(error(no_reward), TrialError::Call(CallError::Reward(_))));
    assert_eq!(error(no_code), TrialError::Call(CallError::Code { function: "step", code: 17 }));
    assert_eq!(error(failing), TrialError::Call(CallError::Failed));
    assert_eq!(error(remembering), TrialError::Repeat);
}

#[test]
fn a_wrong_observation_of_observe_is_told() {
    unsafe extern "C" fn observe(_: *const c_void, _: *const c_void, observation: *mut c_void, _: *mut u8) -> i32 {
        // SAFETY: an observation is an i64.
        unsafe { observation.cast::<i64>().write(1) };
        0
    }
    let found = tried(&Table { observe: Some(observe), ..walk() });
    assert_eq!(found, Err(TrialError::Observe("observation")));
}

#[test]
fn an_empty_state_is_allowed() {
    struct Coin;
    impl qtab_env::Env for Coin {
        type State = ();
        type Number = f64;

        fn num_actions(&self) -> usize {
            2
        }

        fn observation_bounds(&self) -> Vec<(f64, f64)> {
            vec![(f64::NEG_INFINITY, f64::INFINITY)]
        }

        fn reset(&self, _: &mut qtab_env::Generator<'_>) {}

        fn step(&self, (): &(), action: usize, rng: &mut qtab_env::Generator<'_>) -> qtab_env::Step<()> {
            qtab_env::Step::new((), f64::from(u8::from(rng.random() < 0.5 + 0.1 * action as f64)), true)
        }

        fn observe(&self, (): &(), observation: &mut [f64]) {
            observation[0] = 0.0;
        }
    }
    assert_eq!(tried(&table(Coin)), Ok(()));
}
