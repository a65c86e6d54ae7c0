//! Whether `NumPy`'s sine and cosine are the platform's, which Rust calls.
//!
//! Gymnasium's `CartPole`, `Acrobot` and `Pendulum` call `np.sin` and `np.cos`. `NumPy` may compute them with vector
//! code of its own, chosen by its version and the CPU; its last bit is then another in a good part of all calls. There
//! these environments step in Gymnasium's own code: the same numbers come before fast ones.

use numpy::{PyArray1, PyArrayMethods};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

/// Angles of the sizes that the environments meet, ±13. So many find code that rounds one call in ten thousand another
/// way; vector code does so far more often. It takes a few milliseconds, once.
const POINTS: u32 = 100_000;
const WARNING: &str = "NumPy's sin and cos are not the platform's on this machine, so qtab's CartPole, Acrobot and \
                       Pendulum step in Gymnasium's own code: the same numbers, at Gymnasium's speed.";

/// Asked once a process; where they differ, Gymnasium's logger says so.
#[pyfunction]
pub(crate) fn numpy_calls_the_platform(py: Python<'_>) -> PyResult<bool> {
    static ANSWER: PyOnceLock<bool> = PyOnceLock::new();
    if let Some(&equal) = ANSWER.get(py) {
        return Ok(equal);
    }
    let equal = differences(py)? == 0;
    // Kept before the warning, which a filter may turn into an error.
    if ANSWER.set(py, equal).is_ok() && !equal {
        py.import(intern!(py, "gymnasium.logger"))?.call_method1(intern!(py, "warn"), (WARNING,))?;
    }
    Ok(equal)
}

/// At how many of the points either function differs.
fn differences(py: Python<'_>) -> PyResult<usize> {
    let numpy = py.import(intern!(py, "numpy"))?;
    let angles: Vec<f64> = (0..POINTS).map(|n| (f64::from(n) * 0.618_033_988_749_895).fract() * 26.0 - 13.0).collect();
    let points = PyArray1::from_slice(py, &angles);
    let ask = |name: &str| -> PyResult<Vec<f64>> {
        Ok(numpy.getattr(name)?.call1((&points,))?.cast::<PyArray1<f64>>()?.to_vec()?)
    };
    let (sines, cosines) = (ask("sin")?, ask("cos")?);
    let computed = sines.into_iter().zip(cosines);
    Ok(angles.iter().zip(computed).filter(|(angle, pair)| (angle.sin(), angle.cos()) != *pair).count())
}
