//! `qtab._core`: what Python calls. Convert, dispatch, return; nothing else.

#![allow(clippy::needless_pass_by_value, reason = "pyo3 passes arguments by value")]

mod begin;
mod blackjack;
mod classic;
mod discretizer;
mod dispatch;
mod door;
mod failure;
mod finite;
mod learning;
mod many;
mod model;
mod native;
mod numbers;
mod observation;
mod physics;
mod plan;
mod planning;
mod play;
mod python_world;
mod run;
mod stream;
mod table;
mod taxi;
mod toy_text;
mod trainer;
mod trigonometry;
mod vector;

use pyo3::prelude::*;

#[pymodule]
mod _core {
    #[pymodule_export]
    use super::blackjack::Blackjack;
    #[pymodule_export]
    use super::classic::Classic;
    #[pymodule_export]
    use super::many::train_many;
    #[pymodule_export]
    use super::model::parameter_names;
    #[pymodule_export]
    use super::physics::Physics;
    #[pymodule_export]
    use super::planning::{Planner, Valley};
    #[pymodule_export]
    use super::stream::Stream;
    #[pymodule_export]
    use super::table::Transitions;
    #[pymodule_export]
    use super::taxi::Taxi;
    #[pymodule_export]
    use super::toy_text::Table;
    #[pymodule_export]
    use super::trainer::Trainer;
    #[pymodule_export]
    use super::trigonometry::{computes_as_numpy, numpy_calls_the_platform};
    #[pymodule_export]
    use super::vector::Vector;

    /// How the extension was compiled: only "release" says anything about speed.
    #[pymodule_export]
    const BUILD_PROFILE: &str = if cfg!(debug_assertions) { "debug" } else { "release" };
}
