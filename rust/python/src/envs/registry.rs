//! All environments that Rust steps, by their names in `qtab/envs/registry.py`.

use std::sync::Arc;

use pyo3::prelude::*;
use qtab_core::envs::classic_control::{Acrobot, CartPole, ContinuousMountainCar, MountainCar, Pendulum};

use super::book::{changing_maze, k_armed_bandit, maximization_bias, racetrack, short_corridor};
use super::classic_control::DynClassicEnv;
use super::native_env::NativeEnv;
use super::toy_text::{blackjack_env, table_env, taxi_env};
use crate::error::invalid;

/// The constructor of an environment.
#[derive(Clone, Copy)]
pub(super) enum Entry {
    /// Makes the environment with default parameters; they are then read from Gymnasium's environment.
    ClassicControl(fn() -> Arc<dyn DynClassicEnv>),
    /// Makes the environment from Gymnasium's environment.
    FromGymnasium(fn(&Bound<'_, PyAny>) -> PyResult<Arc<dyn NativeEnv>>),
}

const ENVS: &[(&str, Entry)] = &[
    ("Acrobot", Entry::ClassicControl(|| Arc::new(Acrobot::default()))),
    ("Blackjack", Entry::FromGymnasium(blackjack_env)),
    ("CartPole", Entry::ClassicControl(|| Arc::new(CartPole::default()))),
    ("ChangingMaze", Entry::FromGymnasium(changing_maze)),
    ("ContinuousMountainCar", Entry::ClassicControl(|| Arc::new(ContinuousMountainCar::default()))),
    ("KArmedBandit", Entry::FromGymnasium(k_armed_bandit)),
    ("MaximizationBias", Entry::FromGymnasium(maximization_bias)),
    ("MountainCar", Entry::ClassicControl(|| Arc::new(MountainCar::default()))),
    ("Pendulum", Entry::ClassicControl(|| Arc::new(Pendulum::default()))),
    ("Racetrack", Entry::FromGymnasium(racetrack)),
    ("ShortCorridor", Entry::FromGymnasium(short_corridor)),
    ("Table", Entry::FromGymnasium(table_env)),
    ("Taxi", Entry::FromGymnasium(taxi_env)),
];

/// The entry of a name.
pub(super) fn entry(name: &str) -> PyResult<Entry> {
    let found = ENVS.iter().find(|(known, _)| *known == name);
    found.map(|&(_, entry)| entry).ok_or_else(|| invalid("name", "an environment that Rust knows", format!("'{name}'")))
}

/// A classic-control environment with its default parameters.
pub(super) fn classic_control(name: &str) -> PyResult<Arc<dyn DynClassicEnv>> {
    match entry(name)? {
        Entry::ClassicControl(new) => Ok(new()),
        Entry::FromGymnasium(_) => Err(invalid("name", "a classic-control environment", format!("'{name}'"))),
    }
}
