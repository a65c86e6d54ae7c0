//! Checks whether `NumPy`'s sine and cosine equal those of the platform's C library, which Rust calls.
//!
//! Gymnasium's `CartPole`, `Acrobot` and `Pendulum` call `np.sin` and `np.cos`. Depending on its version and on the
//! CPU, `NumPy` computes them with vector code whose last bit differs in a large part of all calls. On such machines
//! these environments step in Gymnasium's own code: equal numbers matter more than speed. `Acrobot`'s initial
//! observation takes the sine and cosine of float32 angles, for which `NumPy` has separate vector code.

use std::sync::OnceLock;

use numpy::{PyArray1, PyArrayMethods};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use qtab_core::numeric::numpy_f32_cos_sin;

use crate::convert::array_from;

/// The number of angles that are compared. This detects code that rounds one call in ten thousand differently; vector
/// code does so far more often. It takes a few milliseconds, once.
const POINTS: u32 = 100_000;
/// The width of an interval around zero that covers the angles of the environments.
const WIDTH: f64 = 26.0;
const WARNING: &str = "NumPy's sin and cos are not the platform's on this machine, so qtab's CartPole, Acrobot and \
                       Pendulum step in Gymnasium's own code: the same numbers, at Gymnasium's speed.";

/// Whether `np.sin` and `np.cos` return the same numbers as the platform's C library. Tested once per process; if they
/// differ, Gymnasium's logger warns.
#[pyfunction]
pub(crate) fn numpy_uses_libm(py: Python<'_>) -> PyResult<bool> {
    static ANSWER: PyOnceLock<bool> = PyOnceLock::new();
    if let Some(&equal) = ANSWER.get(py) {
        return Ok(equal);
    }
    let equal = count_differences(py)? == 0;
    // Stored before the warning, which a filter may turn into an error.
    if ANSWER.set(py, equal).is_ok() && !equal {
        py.import(intern!(py, "gymnasium.logger"))?.call_method1(intern!(py, "warn"), (WARNING,))?;
    }
    Ok(equal)
}

type CosSin = fn(f32) -> [f32; 2];

static F32_COS_SIN: OnceLock<Option<CosSin>> = OnceLock::new();
/// The width of the interval around zero that covers Acrobot's initial angles.
const INITIAL_WIDTH: f64 = 0.2;

/// A function for the cosine and sine of Acrobot's initial float32 angles, ±0.1, that matches `NumPy`: either its
/// vector code or, if it has none, the platform's functions. None if neither matches.
pub(crate) fn f32_cos_sin(py: Python<'_>) -> PyResult<Option<CosSin>> {
    if let Some(&answer) = F32_COS_SIN.get() {
        return Ok(answer);
    }
    let angles: Vec<f32> = spread(INITIAL_WIDTH).map(|angle| angle as f32).collect();
    let expected = numpy_cos_sin::<f32>(py, &angles)?;
    let known: [CosSin; 2] = [numpy_f32_cos_sin, |angle| [angle.cos(), angle.sin()]];
    let answer = known.into_iter().find(|compute| angles.iter().copied().map(compute).eq(expected.iter().copied()));
    // Not computed within `get_or_init`: calling NumPy may let another thread run, which must not find a lock held.
    Ok(*F32_COS_SIN.get_or_init(|| answer))
}

/// The float32 cosine and sine of an angle of any size; `NumPy` computes those that are not known in advance.
pub(super) fn f32_cos_sin_of_any_angle(angle: f32) -> [f32; 2] {
    match F32_COS_SIN.get() {
        Some(Some(compute)) if angle.abs() <= INITIAL_WIDTH as f32 / 2.0 => compute(angle),
        _ => Python::attach(|py| numpy_cos_sin(py, &[angle])).map_or([f32::NAN; 2], |pairs| pairs[0]),
    }
}

/// The number of angles at which `NumPy` and the platform differ.
fn count_differences(py: Python<'_>) -> PyResult<usize> {
    let angles: Vec<f64> = spread(WIDTH).collect();
    let expected = numpy_cos_sin::<f64>(py, &angles)?;
    Ok(angles.iter().zip(expected).filter(|(angle, pair)| (angle.cos(), angle.sin()) != (*pair).into()).count())
}

/// Evenly spread angles in an interval of this width around zero.
fn spread(width: f64) -> impl Iterator<Item = f64> {
    (0..POINTS).map(move |n| ((f64::from(n) * 0.618_033_988_749_895).fract() - 0.5) * width)
}

/// `NumPy`'s cosine and sine of each angle.
fn numpy_cos_sin<T: numpy::Element + Copy>(py: Python<'_>, angles: &[T]) -> PyResult<Vec<[T; 2]>> {
    let numpy = py.import(intern!(py, "numpy"))?;
    let points = array_from(py, angles)?;
    let call = |name: &str| -> PyResult<Vec<T>> {
        Ok(numpy.getattr(name)?.call1((&points,))?.cast::<PyArray1<T>>()?.to_vec()?)
    };
    Ok(call("cos")?.into_iter().zip(call("sin")?).map(|(cos, sin)| [cos, sin]).collect())
}
