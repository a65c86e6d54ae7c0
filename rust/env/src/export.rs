//! The functions in C of an environment that is written in Rust.

#![expect(unsafe_code, reason = "the functions receive addresses")]

use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr;
use std::slice;

use crate::table::{ALIGNMENT, CONTINUES, ENV_VERSION, FAILED, TERMINATED, TRUNCATED, Table};
use crate::{Bitgen, Env, Generator, Number, Step};

/// Exports an environment from a `cdylib` as `qtab_env_1`, for `qtab.NativeEnv`. The argument is an expression that
/// makes a value of a type with [`Env`](crate::Env); it is evaluated once.
#[macro_export]
macro_rules! export_env {
    ($env:expr $(,)?) => {
        /// The environment of this library; null if it cannot be made.
        #[allow(unsafe_code, reason = "an exported function needs its name")]
        #[unsafe(no_mangle)]
        pub extern "C" fn qtab_env_1() -> *const $crate::Table {
            static EXPORTED: ::std::sync::OnceLock<$crate::Exported> = ::std::sync::OnceLock::new();
            EXPORTED.get_or_init(|| $crate::Exported::new(|| $env)).table()
        }
    };
}

/// An exported environment, which is never dropped.
#[derive(Debug)]
pub struct Exported(Option<&'static Table>);

// SAFETY: the table and the environment behind it are immutable, and `Env` requires `Send` and `Sync`.
unsafe impl Send for Exported {}
// SAFETY: as above.
unsafe impl Sync for Exported {}

impl Exported {
    /// Makes an environment and its table. A panic leaves the environment out.
    pub fn new<E: Env>(make: impl FnOnce() -> E) -> Self {
        Self(catch_unwind(AssertUnwindSafe(|| &*Box::leak(Box::new(table_of(make()))))).ok())
    }

    /// The table; null if there is none.
    pub fn table(&self) -> *const Table {
        self.0.map_or(ptr::null(), ptr::from_ref)
    }
}

/// An environment with the sizes in its table, which cannot change even if its methods return others later.
struct Exposed<E> {
    env: E,
    observation_size: usize,
    num_actions: usize,
    has_action_mask: bool,
}

/// The table of an environment.
fn table_of<E: Env>(env: E) -> Table {
    const { assert!(align_of::<E::State>() <= ALIGNMENT, "a state may be aligned to at most 16 bytes") };
    let bounds = env.observation_bounds();
    let max_episode_steps = env.max_episode_steps().map_or(0, i64::from);
    let exposed = Box::leak(Box::new(Exposed {
        observation_size: bounds.len(),
        num_actions: env.num_actions(),
        has_action_mask: env.has_action_mask(),
        env,
    }));
    let leaked = |bound: fn(&(E::Number, E::Number)) -> f64| -> *const f64 {
        Box::leak(bounds.iter().map(bound).collect::<Box<[f64]>>()).as_ptr()
    };
    Table {
        version: ENV_VERSION,
        struct_size: size_of::<Table>() as u32,
        state_size: size_of::<E::State>() as u64,
        observation_type: E::Number::TYPE,
        observation_size: exposed.observation_size.try_into().unwrap_or(u32::MAX),
        observation_low: leaked(|bounds| bounds.0.to_f64()),
        observation_high: leaked(|bounds| bounds.1.to_f64()),
        num_actions: exposed.num_actions.try_into().unwrap_or(i64::MAX),
        max_episode_steps,
        has_action_mask: u32::from(exposed.has_action_mask),
        reserved: 0,
        parameters: ptr::from_ref(exposed).cast(),
        reset: Some(reset::<E>),
        step: Some(step::<E>),
        observe: Some(observe::<E>),
    }
}

/// The result of a function, or `QTAB_FAILED` if it panics. A panic must not reach C.
fn guarded(function: impl FnOnce() -> i32) -> i32 {
    catch_unwind(AssertUnwindSafe(function)).unwrap_or(FAILED)
}

/// `reset` in the table of an environment of type `E`.
unsafe extern "C" fn reset<E: Env>(
    parameters: *const c_void,
    rng: *const Bitgen,
    state: *mut c_void,
    observation: *mut c_void,
    action_mask: *mut u8,
) -> i32 {
    guarded(|| {
        // SAFETY: `parameters` is the address in the table, of an environment that is never dropped.
        let exposed = unsafe { &*parameters.cast::<Exposed<E>>() };
        // SAFETY: the caller passes a valid generator, which nobody else uses during the call.
        let mut rng = unsafe { Generator::new(*rng) };
        let first = exposed.env.reset(&mut rng);
        // SAFETY: `state` has the size and the alignment that the table demands.
        unsafe { state.cast::<E::State>().write(first) };
        // SAFETY: the buffers have the sizes that the table demands.
        unsafe { write_observation(exposed, &first, observation, action_mask) };
        CONTINUES
    })
}

/// `step` in the table of an environment of type `E`.
unsafe extern "C" fn step<E: Env>(
    parameters: *const c_void,
    rng: *const Bitgen,
    state: *const c_void,
    action: i64,
    next_state: *mut c_void,
    observation: *mut c_void,
    reward: *mut f64,
    action_mask: *mut u8,
) -> i32 {
    guarded(|| {
        // SAFETY: as in `reset`; `state` was written by `reset` or `step`.
        let (exposed, state) = unsafe { (&*parameters.cast::<Exposed<E>>(), &*state.cast::<E::State>()) };
        // SAFETY: as in `reset`.
        let mut rng = unsafe { Generator::new(*rng) };
        let next = exposed.env.step(state, action as usize, &mut rng);
        let Step { state, reward: number, terminated, truncated } = next;
        // SAFETY: as in `reset`; `reward` is a float of the caller.
        unsafe {
            next_state.cast::<E::State>().write(state);
            reward.write(number);
            write_observation(exposed, &state, observation, action_mask);
        }
        (if terminated { TERMINATED } else { CONTINUES }) | (if truncated { TRUNCATED } else { CONTINUES })
    })
}

/// `observe` in the table of an environment of type `E`.
unsafe extern "C" fn observe<E: Env>(
    parameters: *const c_void,
    state: *const c_void,
    observation: *mut c_void,
    action_mask: *mut u8,
) -> i32 {
    guarded(|| {
        // SAFETY: as in `step`.
        unsafe {
            let exposed = &*parameters.cast::<Exposed<E>>();
            write_observation(exposed, &*state.cast::<E::State>(), observation, action_mask);
        }
        CONTINUES
    })
}

/// Writes the observation and, if the environment has one, the action mask of a state.
///
/// # Safety
/// The buffers have the sizes that the table demands, and their bytes are initialized.
unsafe fn write_observation<E: Env>(
    exposed: &Exposed<E>,
    state: &E::State,
    observation: *mut c_void,
    action_mask: *mut u8,
) {
    // SAFETY: the caller's buffer has this many numbers, for which every bit pattern is valid.
    let observation = unsafe { slice::from_raw_parts_mut(observation.cast::<E::Number>(), exposed.observation_size) };
    exposed.env.observe(state, observation);
    if exposed.has_action_mask {
        // SAFETY: the caller's buffer has a byte for each action, and 1 is `true`.
        let mask = unsafe {
            action_mask.write_bytes(1, exposed.num_actions);
            slice::from_raw_parts_mut(action_mask.cast::<bool>(), exposed.num_actions)
        };
        exposed.env.action_mask(state, mask);
    }
}
