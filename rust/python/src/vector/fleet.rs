//! Sub-environments of one type behind one face.

use numpy::PyArray1;
use pyo3::exceptions::PyAssertionError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use qtab_core::Env;
use qtab_core::VectorEnv;
use qtab_core::vector::{Autoreset, StepBuffers};

use super::actions::Acts;
use super::infos::{Infos, Nature};
use super::observations::Shows;
use super::source::Source;

/// How sub-environments are to be kept.
#[derive(Clone, Copy)]
pub(super) struct Terms {
    pub(super) size: usize,
    pub(super) max_episode_steps: Option<u64>,
    pub(super) autoreset: Autoreset,
    /// Whether observations are handed out in arrays of their own.
    pub(super) copy: bool,
    /// None: as many as pay.
    pub(super) threads: Option<usize>,
}

/// Observations, rewards, terminations, truncations, infos.
pub(super) type Stepped<'py> =
    (Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyAny>, Bound<'py, PyDict>);

pub(super) type Portrait<'py> = (Bound<'py, PyDict>, u64, bool, Bound<'py, PyAny>);

/// What Python does with sub-environments of any type.
pub(super) trait Steps: Send + Sync {
    fn step<'py>(&mut self, actions: &Bound<'py, PyAny>, sources: &mut [Source]) -> PyResult<Stepped<'py>>;

    /// Begins an episode in each of these.
    fn reset(&mut self, lanes: &[usize], start: Option<[f64; 2]>, sources: &mut [Source]);

    /// The observations, and what a reset of these says.
    fn shown<'py>(&self, py: Python<'py>, lanes: &[usize]) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyDict>)>;

    /// The two numbers that bound first states, under the names of Gymnasium's reset options.
    fn start(&self) -> Option<[(&'static str, f64); 2]>;

    /// What Gymnasium's environment keeps in its attributes, how many steps its episode has had, whether it is over,
    /// and what it shows.
    fn portrait<'py>(&self, py: Python<'py>, lane: usize) -> PyResult<Portrait<'py>>;
}

pub(super) struct Fleet<E: Env> {
    vector: VectorEnv<E>,
    nature: Nature<E>,
    /// The last actions, and those that are being read.
    actions: [Vec<E::Action>; 2],
    observations: Vec<E::Observation>,
    rewards: Vec<f64>,
    terminated: Vec<bool>,
    truncated: Vec<bool>,
    autoreset: Autoreset,
    /// Where observations go that are not copied.
    places: Option<Py<PyAny>>,
}

impl<E> Fleet<E>
where
    E: Env<Action: Acts, Observation: Shows>,
{
    pub(super) fn new(py: Python<'_>, env: E, nature: Nature<E>, terms: Terms) -> PyResult<Self> {
        let Terms { size, max_episode_steps, autoreset, copy, threads } = terms;
        let threads = threads.unwrap_or_else(|| {
            let cores = std::thread::available_parallelism().map_or(1, usize::from);
            cores.min(size / nature.crew)
        });
        let vector = VectorEnv::new(env, size, max_episode_steps, autoreset, threads);
        let observations: Vec<_> = vector.states().map(|state| vector.env().observe(state)).collect();
        let places = if copy { None } else { Some(E::Observation::batched(py, &observations)?.unbind()) };
        Ok(Self {
            vector,
            nature,
            actions: [vec![E::Action::NONE; size], vec![E::Action::NONE; size]],
            observations,
            rewards: vec![0.0; size],
            terminated: vec![false; size],
            truncated: vec![false; size],
            autoreset,
            places,
        })
    }

    fn observed<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let Some(places) = &self.places else { return E::Observation::batched(py, &self.observations) };
        let places = places.bind(py).clone();
        E::Observation::put(&self.observations, &places)?;
        Ok(places)
    }
}

impl<E> Steps for Fleet<E>
where
    E: Env<State: Send + Sync, Action: Acts, Observation: Shows + Sync> + Send + Sync,
{
    fn step<'py>(&mut self, actions: &Bound<'py, PyAny>, sources: &mut [Source]) -> PyResult<Stepped<'py>> {
        let py = actions.py();
        let Self { vector, nature, autoreset, .. } = self;
        if *autoreset == Autoreset::Disabled
            && let Some(lane) = vector.done().position(|over| over)
        {
            let text = "is over: reset it first, with options={'reset_mask': ...}";
            return Err(PyAssertionError::new_err(format!("the episode of sub-environment {lane} {text}")));
        }
        let idle = |lane| *autoreset == Autoreset::NextStep && vector.is_done(lane);
        E::Action::read(actions, vector.env().num_actions(), &idle, &mut self.actions[1])?;
        self.actions.swap(0, 1);

        let batch = StepBuffers {
            observations: &mut self.observations,
            rewards: &mut self.rewards,
            terminated: &mut self.terminated,
            truncated: &mut self.truncated,
        };
        let actions = &self.actions[0];
        if vector.threads() > 1 {
            // Streams that Python has seen are drawn from by threads that attach themselves.
            py.detach(|| vector.step(actions, sources, batch));
        } else {
            vector.step(actions, sources, batch);
        }

        let infos = Infos::new(py, self.rewards.len());
        infos.finals(vector, nature)?;
        infos.step(vector, nature)?;
        Ok((
            self.observed(py)?,
            PyArray1::from_slice(py, &self.rewards).into_any(),
            PyArray1::from_slice(py, &self.terminated).into_any(),
            PyArray1::from_slice(py, &self.truncated).into_any(),
            infos.dict,
        ))
    }

    fn reset(&mut self, lanes: &[usize], start: Option<[f64; 2]>, sources: &mut [Source]) {
        for &lane in lanes {
            self.vector.reset(lane, start, &mut sources[lane]);
        }
        self.vector.observe(&mut self.observations);
    }

    fn shown<'py>(&self, py: Python<'py>, lanes: &[usize]) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyDict>)> {
        let infos = Infos::new(py, self.rewards.len());
        infos.reset(&self.vector, &self.nature, lanes)?;
        Ok((self.observed(py)?, infos.dict))
    }

    fn start(&self) -> Option<[(&'static str, f64); 2]> {
        E::RESET_BOUNDS
    }

    fn portrait<'py>(&self, py: Python<'py>, lane: usize) -> PyResult<Portrait<'py>> {
        let (state, elapsed) = (self.vector.state(lane), self.vector.elapsed(lane));
        let attributes = PyDict::new(py);
        let last = (elapsed > 0).then(|| self.actions[0][lane]);
        (self.nature.portray)(&attributes, self.vector.env(), state, last)?;
        if self.vector.is_done(lane) && self.terminated[lane] {
            self.nature.fell.map_or(Ok(()), |name| attributes.set_item(name, 0))?;
        }
        Ok((attributes, elapsed, self.vector.is_done(lane), self.observations[lane].alone(py)?))
    }
}
