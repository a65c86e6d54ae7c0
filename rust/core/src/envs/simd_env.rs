//! The trait of environments that step in SIMD lanes.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use super::Env;
use crate::numeric::{LANES, SimdCode, SimdLevel, cold_path};
use crate::random::NoRng;

/// An environment whose deterministic dynamics can be computed in SIMD lanes. The state is `M` numbers, and the
/// observation is the state in float32.
pub trait SimdEnv<const M: usize>:
    Copy + PartialEq + Env<Action = usize, State: From<[f64; M]> + Into<[f64; M]>, Observation = [f32; M]>
{
    /// Whether `step_soa` has the results of `step` with these parameters on this platform.
    fn is_exact(&self) -> bool;

    /// One step in `K` lanes, in place. `fields` holds the states as a structure of arrays: one array per component.
    /// Returns whether each next state is terminal. `FUSED` is that of the [`SimdLevel`] which the code is compiled for.
    fn step_soa<const FUSED: bool, const K: usize>(&self, fields: &mut [[f64; K]; M], actions: &[usize; K]) -> [bool; K];

    /// The reward of a step, which depends only on whether the next state is terminal.
    fn reward(&self, terminated: bool) -> f64;
}

/// [`Env::step_batch`] in SIMD lanes.
pub(crate) fn step_batch<E: SimdEnv<M>, const M: usize>(
    env: &E,
    states: &mut [E::State],
    actions: &[usize],
    rewards: &mut [f64],
    terminated: &mut [bool],
    inactive: &[bool],
) {
    let in_lanes = if env.is_exact() { states.len() / LANES * LANES } else { 0 };
    let (chunks, rest) = states.split_at_mut(in_lanes);
    if in_lanes > 0 {
        let (states, actions) = (chunks.as_chunks_mut().0, actions.as_chunks().0);
        let (terminated, inactive) = (terminated.as_chunks_mut().0, inactive.as_chunks().0);
        SimdLevel::detect().run(Chunks { env: *env, states, actions, terminated, inactive });
    }
    for (index, state) in (in_lanes..).zip(rest).filter(|(index, _)| !inactive[*index]) {
        let step = env.step(*state, actions[index], &mut NoRng);
        (*state, terminated[index]) = (step.state, step.terminated);
    }
    for (reward, &terminated) in rewards.iter_mut().zip(&*terminated) {
        *reward = env.reward(terminated);
    }
}

/// Sub-environments in chunks of [`LANES`], compiled for each [`SimdLevel`].
struct Chunks<'a, E, S> {
    env: E,
    states: &'a mut [[S; LANES]],
    actions: &'a [[usize; LANES]],
    terminated: &'a mut [[bool; LANES]],
    inactive: &'a [[bool; LANES]],
}

impl<E: SimdEnv<M, State = S>, S: Copy + From<[f64; M]> + Into<[f64; M]>, const M: usize> SimdCode for Chunks<'_, E, S>
where
    E: Env<Observation = [f32; M]>,
{
    type Output = ();

    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let env = self.env;
        let outputs = self.states.iter_mut().zip(self.terminated);
        for ((states, terminated), (actions, inactive)) in outputs.zip(self.actions.iter().zip(self.inactive)) {
            let mut fields = [[0.0; LANES]; M];
            (0..LANES).for_each(|lane| scatter(&mut fields, lane, states[lane]));
            if *inactive == [false; LANES] {
                *terminated = env.step_soa::<FUSED, _>(&mut fields, actions);
                (0..LANES).for_each(|lane| states[lane] = gather(&fields, lane));
                continue;
            }
            cold_path();
            let actions = std::array::from_fn(|lane| if inactive[lane] { 0 } else { actions[lane] });
            *terminated = env.step_soa::<FUSED, _>(&mut fields, &actions);
            for lane in (0..LANES).filter(|&lane| !inactive[lane]) {
                states[lane] = gather(&fields, lane);
            }
        }
    }
}

/// Writes a state to a lane.
#[inline(always)]
pub(crate) fn scatter<S: Into<[f64; M]>, const K: usize, const M: usize>(
    fields: &mut [[f64; K]; M],
    lane: usize,
    state: S,
) {
    for (field, number) in fields.iter_mut().zip(state.into()) {
        field[lane] = number;
    }
}

/// Reads the state of a lane.
#[inline(always)]
pub(crate) fn gather<S: From<[f64; M]>, const K: usize, const M: usize>(fields: &[[f64; K]; M], lane: usize) -> S {
    std::array::from_fn(|field| fields[field][lane]).into()
}
