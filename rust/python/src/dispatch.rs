//! The choice of a world: what Python hands over as the environment.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use qtab_core::Features;
use qtab_core::features::MAX_TILINGS;
use qtab_core::numeric::Float;

use crate::classic::Control;
use crate::discretizer::Discretizer;
use crate::finite::{Bias, Process, Rules};
use crate::learning::{Built, Kept, boxed};
use crate::observation::{Floats, Integers, Reader};
use crate::plan::Plan;
use crate::python_world::{PythonEnvironment, PythonWorld};

/// What a plan is run on: a model, a table, blackjack's rules, or an environment.
pub(crate) fn build(environment: &Bound<'_, PyAny>, plan: &Plan<'_>) -> PyResult<Built> {
    let py = environment.py();
    if let Ok(control) = environment.extract::<Control>() {
        return control.build(py, plan);
    }
    if let Ok(process) = environment.extract::<Process>() {
        return process.build(py, plan);
    }
    if let Ok(rules) = environment.extract::<Rules>() {
        return rules.build(plan);
    }
    if let Ok(bias) = environment.extract::<Bias>() {
        return bias.build(plan);
    }
    match environment.extract::<PythonEnvironment>() {
        Ok(environment) => python(environment, plan),
        Err(error) => Err(PyTypeError::new_err(format!("no environment to train on: {error}"))),
    }
}

/// A run that steps a Python environment.
fn python(environment: PythonEnvironment, plan: &Plan<'_>) -> PyResult<Built> {
    if let Discretizer::Cells { first, counts, scalar } = &plan.features {
        let axes: Vec<_> = first.iter().copied().zip(counts.iter().copied()).collect();
        let rows = axes.iter().map(|&(_, count)| count as usize).product();
        attached(environment, Integers { axes, scalar: *scalar }, rows, 1, plan)
    } else if plan.single {
        python_of(environment, plan, |bound| bound as f32)
    } else {
        python_of(environment, plan, |bound| bound)
    }
}

fn python_of<T>(environment: PythonEnvironment, plan: &Plan<'_>, dtype: impl Fn(f64) -> T) -> PyResult<Built>
where
    T: Float + numpy::Element + 'static,
{
    if let Discretizer::Tiles { tilings: lit, .. } = &plan.features {
        let tiles = plan.tiles::<T, MAX_TILINGS>()?;
        let rows = Features::<[T]>::len(&tiles);
        return attached(environment, Floats::new(tiles, plan.low.len()), rows, *lit, plan);
    }
    let grid = plan.grid(dtype)?;
    let rows = Features::<[T]>::len(&grid);
    attached(environment, Floats::new(grid, plan.low.len()), rows, 1, plan)
}

fn attached<R>(environment: PythonEnvironment, reader: R, rows: usize, lit: u32, plan: &Plan<'_>) -> PyResult<Built>
where
    R: Reader<Rows: Send> + Send + 'static,
{
    let world = PythonWorld::new(environment, reader, plan);
    boxed(world, rows, lit as usize, plan.stream()?, plan, Kept::Python, true)
}
