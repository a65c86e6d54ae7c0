//! Python's choice into a trainer: the hot combination whole, every other one through a boxed world.

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use qtab_core::features::Features;
use qtab_core::random::Stream;
use qtab_core::worlds::{Boxed, Native, Recorded, Recordings, Start};
use qtab_core::{Trainer, World};

use crate::failure::Failure;
use crate::model::Model;
use crate::plan::Plan;
use crate::python_world::{PythonEnvironment, PythonWorld};
use crate::run::Run;

/// The last episodes of a run, where it was asked to keep them.
pub(crate) enum Kept {
    Nothing,
    Native(Recordings<(u64, Option<u32>)>),
    Python(Recordings<Py<PyAny>>),
}

/// A run that has not begun.
pub(crate) struct Built {
    pub(crate) run: Box<dyn Run>,
    pub(crate) kept: Kept,
    /// Whether it steps Python, and so stays on the calling thread, attached.
    pub(crate) attached: bool,
}

/// A run of a model in Rust, its constants as they are.
pub(crate) fn native(model: Model, plan: &Plan<'_>) -> PyResult<Built> {
    let Model::MountainCar(env) = model else {
        return Err(PyValueError::new_err("model must be 'MountainCar' to be trained in Rust"));
    };
    let grid = plan.plane()?;
    let rows = Features::<[f32; 2]>::len(&grid);
    let world = Native::new(env, grid, plan.max_episode_steps, plan.environment_stream());
    let mut draw = plan.stream()?;
    if let (Stream::Pcg64(draw), 0) = (&mut draw, plan.record) {
        let learner = plan.q_learning::<3>(rows, draw)?;
        let run = Box::new(Trainer::new(world, learner, draw.clone()));
        return Ok(Built { run, kept: Kept::Nothing, attached: false });
    }
    boxed(world, rows, draw, plan, Kept::Native, false)
}

/// A run that steps a Python environment.
pub(crate) fn python(environment: PythonEnvironment, plan: &Plan<'_>) -> PyResult<Built> {
    let draw = plan.stream()?;
    if plan.single {
        let world = PythonWorld::new(environment, plan.axes(|bound| bound as f32), plan.max_episode_steps);
        let rows = world.len();
        boxed(world, rows, draw, plan, Kept::Python, true)
    } else {
        let world = PythonWorld::new(environment, plan.axes(|bound| bound), plan.max_episode_steps);
        let rows = world.len();
        boxed(world, rows, draw, plan, Kept::Python, true)
    }
}

fn boxed<W>(
    world: W,
    rows: usize,
    mut draw: Stream,
    plan: &Plan<'_>,
    kept: impl FnOnce(Recordings<W::Start>) -> Kept,
    attached: bool,
) -> PyResult<Built>
where
    W: Start + World<Rows = [u32; 1], State: Send, Error: Into<Failure>> + Send + 'static,
    W::Start: Send,
    Failure: From<W::Error>,
{
    let learner = plan.q_learning::<0>(rows, &mut draw)?;
    let (world, kept) = if plan.record == 0 {
        (Boxed::<_, Failure>::new(world), Kept::Nothing)
    } else {
        let (world, recordings) = Recorded::new(world, plan.record);
        (Boxed::new(world), kept(recordings))
    };
    Ok(Built { run: Box::new(Trainer::new(world, learner, draw)), kept, attached })
}

/// What a plan is run on: the name of a model with its constants, or an environment.
pub(crate) fn build(environment: &Bound<'_, PyAny>, plan: &Plan<'_>) -> PyResult<Built> {
    if let Ok(model) = environment.extract::<Description>() {
        return native(model.resolve()?, plan);
    }
    match environment.extract::<PythonEnvironment>() {
        Ok(environment) => python(environment, plan),
        Err(error) => Err(PyTypeError::new_err(format!("no environment to train on: {error}"))),
    }
}

#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Description {
    model: String,
    parameters: std::collections::HashMap<String, f64>,
}

impl Description {
    fn resolve(self) -> PyResult<Model> {
        let mut model = Model::new(&self.model)?;
        for (name, value) in self.parameters {
            let parameter = model.constants().parameter(&name);
            *parameter.ok_or_else(|| PyValueError::new_err(format!("the model has no parameter {name:?}")))? = value;
        }
        Ok(model)
    }
}
