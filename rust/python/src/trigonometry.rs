//! Whether `NumPy`'s sine and cosine are the platform's, which Rust calls.
//!
//! Gymnasium's `CartPole`, `Acrobot` and `Pendulum` call `np.sin` and `np.cos`. `NumPy` may compute them with vector
//! code of its own, chosen by its version and the CPU; its last bit is then another in a good part of all calls. There
//! these environments step in Gymnasium's own code: the same numbers come before fast ones. `Acrobot`'s first observation
//! takes them of single-precision angles, too, which `NumPy` has vector code of its own for.

use std::sync::OnceLock;

use numpy::{PyArray1, PyArrayMethods};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use qtab_core::numeric::numpy_f32_cos_sin;

use crate::model::Model;

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

/// Whether a model in Rust makes the numbers of Gymnasium's environment on this machine, its reset included.
#[pyfunction]
pub(crate) fn computes_as_numpy(py: Python<'_>, model: &str) -> PyResult<bool> {
    let model = Model::new(model)?;
    if model.habits().trigonometry && !numpy_calls_the_platform(py)? {
        return Ok(false);
    }
    Ok(!matches!(model, Model::Acrobot(_)) || single_precision(py)?.is_some())
}

type CosineAndSine = fn(f32) -> [f32; 2];

static SINGLE: OnceLock<Option<CosineAndSine>> = OnceLock::new();
/// Of the interval around zero that Acrobot's first states fill.
const WIDTH: f64 = 0.2;

/// The cosine and the sine of a single-precision angle as `NumPy` computes those of Acrobot's first states, ±0.1: by its
/// vector code or, where it has none, by the platform's. None where it is neither.
pub(crate) fn single_precision(py: Python<'_>) -> PyResult<Option<CosineAndSine>> {
    if let Some(&answer) = SINGLE.get() {
        return Ok(answer);
    }
    let angles: Vec<f32> = spread(WIDTH).map(|angle| angle as f32).collect();
    let expected = ask::<f32>(py, &angles)?;
    let known: [CosineAndSine; 2] = [numpy_f32_cos_sin, |angle| [angle.cos(), angle.sin()]];
    let answer = known.into_iter().find(|compute| angles.iter().copied().map(compute).eq(expected.iter().copied()));
    // Computed before, since asking NumPy may let another thread go on, which must not find a lock held.
    Ok(*SINGLE.get_or_init(|| answer))
}

/// The same of any angle, for those who may begin elsewhere: what is not known beforehand, `NumPy` computes.
pub(crate) fn of_any_angle(angle: f32) -> [f32; 2] {
    match SINGLE.get() {
        Some(Some(compute)) if angle.abs() <= WIDTH as f32 / 2.0 => compute(angle),
        _ => Python::attach(|py| ask(py, &[angle])).map_or([f32::NAN; 2], |pairs| pairs[0]),
    }
}

/// At how many of the points either function differs.
fn differences(py: Python<'_>) -> PyResult<usize> {
    let angles: Vec<f64> = spread(26.0).collect();
    let expected = ask::<f64>(py, &angles)?;
    Ok(angles.iter().zip(expected).filter(|(angle, pair)| (angle.cos(), angle.sin()) != (*pair).into()).count())
}

/// Angles that fill so wide an interval around zero.
fn spread(width: f64) -> impl Iterator<Item = f64> {
    (0..POINTS).map(move |n| ((f64::from(n) * 0.618_033_988_749_895).fract() - 0.5) * width)
}

/// `NumPy`'s cosines and sines.
fn ask<T: numpy::Element + Copy>(py: Python<'_>, angles: &[T]) -> PyResult<Vec<[T; 2]>> {
    let numpy = py.import(intern!(py, "numpy"))?;
    let points = PyArray1::from_slice(py, angles);
    let call = |name: &str| -> PyResult<Vec<T>> {
        Ok(numpy.getattr(name)?.call1((&points,))?.cast::<PyArray1<T>>()?.to_vec()?)
    };
    Ok(call("cos")?.into_iter().zip(call("sin")?).map(|(cosine, sine)| [cosine, sine]).collect())
}
