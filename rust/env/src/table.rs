//! The types of `qtab_env.h`, with their layout in C.

use std::ffi::c_void;

/// `QTAB_ENV_VERSION`, the version of the interface.
pub const ENV_VERSION: u32 = 1;

/// The alignment of a state in bytes.
pub const ALIGNMENT: usize = 16;

/// `QTAB_FLOAT32`: observations are float32.
pub const FLOAT32: u32 = 0;
/// `QTAB_FLOAT64`: observations are float64.
pub const FLOAT64: u32 = 1;
/// `QTAB_INT64`: observations are int64.
pub const INT64: u32 = 2;

/// `QTAB_CONTINUES`: the episode continues.
pub const CONTINUES: i32 = 0;
/// `QTAB_TERMINATED`: the next state is terminal.
pub const TERMINATED: i32 = 1;
/// `QTAB_TRUNCATED`: the episode was cut off.
pub const TRUNCATED: i32 = 2;
/// `QTAB_FAILED`: the function failed, and its output is ignored.
pub const FAILED: i32 = -1;

/// `qtab_bitgen`, a random generator: the `bitgen_t` of `NumPy`.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Bitgen {
    /// The argument of the functions.
    pub state: *mut c_void,
    /// The next 64 random bits.
    pub next_uint64: unsafe extern "C" fn(*mut c_void) -> u64,
    /// The next 32 random bits.
    pub next_uint32: unsafe extern "C" fn(*mut c_void) -> u32,
    /// The next float in [0, 1).
    pub next_double: unsafe extern "C" fn(*mut c_void) -> f64,
    /// The next word as the generator makes it.
    pub next_raw: unsafe extern "C" fn(*mut c_void) -> u64,
}

/// `reset` of a [`Table`]: `(parameters, rng, state, observation, action_mask)`.
pub type ResetFunction = unsafe extern "C" fn(*const c_void, *const Bitgen, *mut c_void, *mut c_void, *mut u8) -> i32;

/// `step` of a [`Table`]: `(parameters, rng, state, action, next_state, observation, reward, action_mask)`.
pub type StepFunction = unsafe extern "C" fn(
    *const c_void,
    *const Bitgen,
    *const c_void,
    i64,
    *mut c_void,
    *mut c_void,
    *mut f64,
    *mut u8,
) -> i32;

/// `observe` of a [`Table`]: `(parameters, state, observation, action_mask)`.
pub type ObserveFunction = unsafe extern "C" fn(*const c_void, *const c_void, *mut c_void, *mut u8) -> i32;

/// `qtab_env`, an environment as a table of sizes and functions. The header explains each field.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Table {
    /// [`ENV_VERSION`].
    pub version: u32,
    /// The size of this struct.
    pub struct_size: u32,
    /// The number of bytes of a state.
    pub state_size: u64,
    /// [`FLOAT32`], [`FLOAT64`] or [`INT64`].
    pub observation_type: u32,
    /// The number of numbers of an observation.
    pub observation_size: u32,
    /// The lowest values of an observation; null if they are unbounded.
    pub observation_low: *const f64,
    /// The highest values of an observation; null if they are unbounded.
    pub observation_high: *const f64,
    /// The number of actions.
    pub num_actions: i64,
    /// The time limit in steps; 0 for none.
    pub max_episode_steps: i64,
    /// 1 if the functions write an action mask.
    pub has_action_mask: u32,
    /// 0.
    pub reserved: u32,
    /// The first argument of the functions.
    pub parameters: *const c_void,
    /// Begins an episode.
    pub reset: Option<ResetFunction>,
    /// Takes a step.
    pub step: Option<StepFunction>,
    /// Writes the observation and the action mask of a state.
    pub observe: Option<ObserveFunction>,
}
