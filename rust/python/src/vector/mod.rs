//! The base of the vector environments: all sub-environments' step in one call, Gymnasium's contract around it.

mod actions;
mod fleet;
mod infos;
mod observations;
mod portraits;
mod source;

use pyo3::exceptions::{PyIndexError, PyRuntimeError, PyValueError};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple, PyType};
use qtab_core::Env;
use qtab_core::envs::classic_control::Acrobot;
use qtab_core::envs::toy_text::{Blackjack, Taxi, TaxiState};
use qtab_core::envs::wrappers::{BlackjackWithHistory, TransitionProbabilityState, WithTransitionProbability};
use qtab_core::vector::Autoreset;

use crate::finite::{Process, Rules};
use crate::model::Model;
use crate::physics::Physics;
use crate::trigonometry::{of_any_angle, single_precision};
use actions::Acts;
use fleet::{Fleet, Steps, Terms};
use infos::{Masks, Nature, Says};
use observations::Shows;
use source::{Source, words};

/// Sub-environments in Rust, or none, as long as they are stepped in Python.
#[pyclass(subclass, module = "qtab._core")]
pub(crate) struct Vector {
    fleet: Option<Box<dyn Steps>>,
    sources: Vec<Source>,
    /// What each was seeded with, as 32-bit words.
    seeds: Vec<Vec<u32>>,
    /// Whether each was reset; empty once all were.
    missing: Vec<bool>,
}

/// What there is a sub-environment of in Rust.
#[derive(FromPyObject)]
enum Kind {
    Process(Process),
    Rules(Rules),
}

#[pymethods]
impl Vector {
    #[new]
    #[pyo3(signature = (*_args, **_kwargs))]
    fn new(_args: &Bound<'_, PyTuple>, _kwargs: Option<&Bound<'_, PyDict>>) -> Self {
        Self { fleet: None, sources: vec![], seeds: vec![], missing: vec![] }
    }

    /// Makes sub-environments that are what `example` is, with the help of what toy text says of itself: its table or
    /// its rules, and its action masks. False, and nothing done, where Rust does not stand for it.
    #[expect(clippy::too_many_arguments, reason = "it is called once, with their names")]
    fn launch(
        &mut self,
        example: &Bound<'_, PyAny>,
        kind: Option<Kind>,
        masks: Option<Vec<[i8; 6]>>,
        num_envs: usize,
        max_episode_steps: Option<u64>,
        autoreset_mode: &str,
        copy: bool,
        threads: Option<usize>,
    ) -> PyResult<bool> {
        let py = example.py();
        let autoreset = match autoreset_mode {
            "NextStep" => Autoreset::NextStep,
            "SameStep" => Autoreset::SameStep,
            "Disabled" => Autoreset::Disabled,
            _ => return Err(PyValueError::new_err(format!("autoreset_mode must be a mode, got {autoreset_mode:?}"))),
        };
        let terms = Terms { size: num_envs, max_episode_steps, autoreset, copy, threads };
        self.fleet = match kind {
            Some(kind) => Some(toys(py, kind, masks, terms)?),
            None => match example.cast::<Physics>().ok().map(Physics::model).transpose()?.flatten() {
                Some(model) => Some(classics(py, model, terms)?),
                None => None,
            },
        };
        if self.fleet.is_none() {
            return Ok(false);
        }
        // As many bytes of entropy for each as NumPy takes.
        let entropy: Vec<u8> = py.import("os")?.call_method1("urandom", (16 * num_envs,))?.extract()?;
        let word = |bytes: &[u8; 4]| u32::from_le_bytes(*bytes);
        self.seeds = entropy.chunks(16).map(|bytes| bytes.as_chunks().0.iter().map(word).collect()).collect();
        self.sources = self.seeds.iter().map(|seed| Source::new(seed)).collect();
        self.missing = vec![true; num_envs];
        Ok(true)
    }

    /// Whether Rust steps the sub-environments.
    #[getter]
    fn launched(&self) -> bool {
        self.fleet.is_some()
    }

    /// One step of all sub-environments, with the types that Gymnasium returns.
    fn step<'py>(slf: &Bound<'py, Self>, actions: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let busy = |_| PyRuntimeError::new_err("another thread is stepping these sub-environments");
        let mut this = slf.try_borrow_mut().map_err(busy)?;
        let Self { fleet: Some(fleet), sources, missing, .. } = &mut *this else {
            drop(this);
            return slf.call_method1(intern!(py, "step_in_python"), (actions,));
        };
        if let Some(lane) = missing.iter().position(|&missing| missing) {
            let class = py.import("gymnasium.error")?.getattr("ResetNeeded")?.cast_into::<PyType>()?;
            let text = format!("Cannot call env.step() before calling env.reset(): sub-environment {lane}");
            return Err(PyErr::from_type(class, text));
        }
        Ok(fleet.step(actions, sources)?.into_pyobject(py)?.into_any())
    }

    /// Begins an episode in each of `lanes`, with a seed for each or None for the stream as it stands, and returns all
    /// observations, and infos of those.
    fn begin<'py>(
        &mut self,
        py: Python<'py>,
        lanes: Vec<usize>,
        seeds: Vec<Option<Bound<'py, PyAny>>>,
        start: Option<[f64; 2]>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyDict>)> {
        let Some(fleet) = &mut self.fleet else { return Err(PyValueError::new_err("no sub-environments")) };
        if let Some(&lane) = lanes.iter().find(|&&lane| lane >= self.sources.len()) {
            return Err(nobody(lane));
        }
        let seeds = seeds.iter().map(|seed| seed.as_ref().map(words).transpose()).collect::<PyResult<Vec<_>>>()?;
        for (&lane, seed) in lanes.iter().zip(seeds) {
            if let Some(seed) = seed {
                self.sources[lane] = Source::new(&seed);
                self.seeds[lane] = seed;
            }
        }
        fleet.reset(&lanes, start, &mut self.sources);
        if !self.missing.is_empty() {
            for &lane in &lanes {
                self.missing[lane] = false;
            }
            if !self.missing.contains(&true) {
                self.missing.clear();
            }
        }
        fleet.shown(py, &lanes)
    }

    /// Which sub-environments were never reset.
    fn unbegun(&self) -> Vec<usize> {
        (0..self.missing.len()).filter(|&lane| self.missing[lane]).collect()
    }

    /// The options that bound first states, and their defaults.
    fn start(&self) -> Option<[(&'static str, f64); 2]> {
        self.fleet.as_ref().and_then(|fleet| fleet.start())
    }

    /// What a sub-environment was seeded with.
    fn seed_of<'py>(&self, py: Python<'py>, lane: usize) -> PyResult<Bound<'py, PyAny>> {
        let seed = self.seeds.get(lane).ok_or_else(|| nobody(lane))?;
        let bytes: Vec<u8> = seed.iter().flat_map(|word| word.to_le_bytes()).collect();
        py.get_type::<pyo3::types::PyInt>().call_method1("from_bytes", (bytes.as_slice(), "little"))
    }

    /// Its generator, or how many words it has drawn since it was seeded and its buffered half.
    fn source<'py>(&self, py: Python<'py>, lane: usize) -> PyResult<Bound<'py, PyAny>> {
        match self.sources.get(lane).ok_or_else(|| nobody(lane))? {
            Source::Own(stream) => Ok((stream.words_drawn(), stream.buffered_u32()).into_pyobject(py)?.into_any()),
            Source::Python(generator) => Ok(generator.bind(py).clone()),
        }
    }

    /// It draws from that `numpy.random.Generator` from now on.
    fn draw_from(&mut self, lane: usize, generator: Py<PyAny>) -> PyResult<()> {
        *self.sources.get_mut(lane).ok_or_else(|| nobody(lane))? = Source::Python(generator);
        Ok(())
    }

    /// The attributes of each, how many steps its episode has had, and whether it is over: all that it takes to step it
    /// elsewhere.
    fn portraits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let Some(fleet) = &self.fleet else { return Ok(PyList::empty(py)) };
        let all = (0..self.sources.len()).map(|lane| fleet.portrait(py, lane));
        PyList::new(py, all.collect::<PyResult<Vec<_>>>()?)
    }

    /// Rust steps nothing any more.
    fn retire(&mut self) {
        self.fleet = None;
    }
}

fn nobody(lane: usize) -> PyErr {
    PyIndexError::new_err(format!("there is no sub-environment {lane}"))
}

fn boxed<E>(py: Python<'_>, env: E, nature: Nature<E>, terms: Terms) -> PyResult<Box<dyn Steps>>
where
    E: Env<State: Send + Sync, Action: Acts, Observation: Shows + Sync> + Send + Sync + 'static,
{
    Ok(Box::new(Fleet::new(py, env, nature, terms)?))
}

/// Classic control: one arm each.
fn classics(py: Python<'_>, model: Model, terms: Terms) -> PyResult<Box<dyn Steps>> {
    // A crew's step takes about a quarter of a millisecond.
    match model {
        Model::MountainCar(env) => boxed(py, env, Nature::new(16_384, portraits::car), terms),
        Model::CartPole(env) => {
            let nature = Nature::new(16_384, portraits::plain::<_, 4>);
            boxed(py, env, Nature { fell: Some("steps_beyond_terminated"), ..nature }, terms)
        }
        Model::Acrobot(env) => {
            single_precision(py)?;
            let env = Acrobot { f32_cos_sin: of_any_angle, ..env };
            boxed(py, env, Nature::new(512, portraits::acrobot), terms)
        }
        Model::Pendulum(env) => boxed(py, env, Nature::new(2048, portraits::pendulum), terms),
        Model::ContinuousMountainCar(env) => boxed(py, env, Nature::new(4096, portraits::continuous_car), terms),
    }
}

/// Toy text.
fn toys(py: Python<'_>, kind: Kind, masks: Option<Vec<[i8; 6]>>, terms: Terms) -> PyResult<Box<dyn Steps>> {
    let Process { table, fickle } = match kind {
        Kind::Process(process) => process,
        Kind::Rules(Rules { natural, sab }) => {
            let nature = Nature::new(4096, portraits::blackjack);
            return boxed(py, BlackjackWithHistory(Blackjack { natural, sab }), nature, terms);
        }
    };
    let table = table.get().0.clone();
    let Some(masks) = masks else {
        let says =
            Says { probability: |told: &TransitionProbabilityState<_>| told.probability, whole: true, masks: None };
        let nature = Nature { says: Some(says), ..Nature::new(16_384, portraits::table) };
        return boxed(py, WithTransitionProbability(table), nature, terms);
    };
    let masks = Masks { table: masks, cell: |told: &TransitionProbabilityState<TaxiState>| told.state.cell as usize };
    let says =
        Says { probability: |told: &TransitionProbabilityState<_>| told.probability, whole: false, masks: Some(masks) };
    let nature = Nature { says: Some(says), ..Nature::new(16_384, portraits::taxi) };
    boxed(py, WithTransitionProbability(Taxi { table, fickle }), nature, terms)
}
