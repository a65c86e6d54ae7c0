//! `qtab._core`: the extension module. It converts, dispatches and returns; `qtab-core` does the computing.

#![allow(clippy::needless_pass_by_value, reason = "pyo3 passes arguments by value")]

mod convert;
mod discretizer;
mod envs;
mod error;
mod interrupt;
mod locks;
mod planning;
mod rng;
mod runs;
mod spec;
mod training;
mod vector;

use pyo3::prelude::*;

// The module does not need the GIL: docs/explanation/free_threading.md lists the data that threads share, and its
// guards.
#[pymodule(gil_used = false)]
mod _core {
    use pyo3::exceptions::PyImportError;
    use pyo3::types::PyTuple;
    use qtab_core::settings::{AlgorithmRows, SCHEDULES};
    use qtab_core::simd::{SimdLevel, SimdLimit};

    use super::error::CompiledCodeError;
    use super::spec::{DISCRETIZERS, Fields};
    use super::{Bound, PyModule, PyModuleMethods, PyResult};

    #[pymodule_export]
    use super::discretizer::PyDiscretizer;
    #[pymodule_export]
    use super::envs::{
        PyBlackjack, PyClassicControl, PyExternalEnv, PyExternalEpisode, PyNativeEnv, PyTaxi, PyToyText,
        PyTransitionTable, PyVectorEnv, matches_numpy, numpy_uses_libm, parameter_names, step_cart_poles,
    };
    #[pymodule_export]
    use super::planning::{PyExpectedUpdates, PyGridSearch, PyMdpSolver};
    #[pymodule_export]
    use super::rng::PyAgentRng;
    #[pymodule_export]
    use super::training::{PyTrainer, estimate_values, run_testbeds, train_many};

    /// The version of the package. Reading it from Python's metadata takes ten times as long.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");

    /// The build profile of the extension: only "release" is meaningful for measuring speed.
    #[pymodule_export]
    const BUILD_PROFILE: &str = if cfg!(debug_assertions) { "debug" } else { "release" };

    /// Adds the words that a spec may use. `QTAB_SIMD=plain` or `=avx2` turns wider vector instructions off.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        let py = module.py();
        if let Some(name) = std::env::var_os("QTAB_SIMD").filter(|name| !name.is_empty()) {
            let Some(limit) = name.to_str().and_then(SimdLimit::from_name) else {
                let known = SimdLimit::NAMES.map(|(known, _)| format!("'{known}'")).join(", ");
                let name = name.display();
                let message = format!("the environment variable QTAB_SIMD must be {known} or unset, got '{name}'");
                return Err(PyImportError::new_err(message));
            };
            SimdLevel::restrict(limit);
        }
        module.add("CompiledCodeError", py.get_type::<CompiledCodeError>())?;
        module.add("ALGORITHMS", PyTuple::new(py, AlgorithmRows::<Fields<'_>>::ROWS.map(|(name, _)| name))?)?;
        module.add("DISCRETIZERS", PyTuple::new(py, DISCRETIZERS.iter().map(|(name, _)| name))?)?;
        module.add("SCHEDULES", PyTuple::new(py, SCHEDULES.iter().map(|(name, _)| name))?)
    }
}
