//! Many environments at once, in the processor's wide registers: never with other results than one by one.

#![expect(clippy::inline_always, reason = "what is compiled for each instruction set must be inlined to be so")]

use super::Env;
use crate::random::NoRng;

/// How many environments go together best.
pub(crate) const LANES: usize = 8;

/// Physics of `M` numbers, without chance, computed in many lanes at once. The observation is the state in single
/// precision.
pub trait SimdEnv<const M: usize>:
    Copy + PartialEq + Env<Action = usize, State: From<[f64; M]> + Into<[f64; M]>, Observation = [f32; M]>
{
    /// Whether the lanes' results are those of `step` with these constants, on this machine.
    fn is_exact(&self) -> bool;

    /// One step in `K` lanes: their states, field by field, move on. Returns which of them are terminal.
    fn step_soa<const K: usize>(&self, fields: &mut [[f64; K]; M], actions: &[usize; K]) -> [bool; K];

    /// What a step brings that ends there, or not.
    fn reward(&self, terminated: bool) -> f64;
}

/// [`Env::step_lanes`], for wide physics.
pub(crate) fn step_batch<E: SimdEnv<M>, const M: usize>(
    env: &E,
    states: &mut [E::State],
    actions: &[usize],
    rewards: &mut [f64],
    terminated: &mut [bool],
    inactive: &[bool],
) {
    let together = if env.is_exact() { states.len() / LANES * LANES } else { 0 };
    let (wide, rest) = states.split_at_mut(together);
    if together > 0 {
        let (states, actions) = (wide.as_chunks_mut().0, actions.as_chunks().0);
        let (terminated, inactive) = (terminated.as_chunks_mut().0, inactive.as_chunks().0);
        pulp::Arch::new().dispatch(Chunks { env: *env, states, actions, terminated, inactive });
    }
    for (lane, state) in (together..).zip(rest).filter(|(lane, _)| !inactive[*lane]) {
        let step = env.step(*state, actions[lane], &mut NoRng);
        (*state, terminated[lane]) = (step.state, step.terminated);
    }
    for (reward, &end) in rewards.iter_mut().zip(&*terminated) {
        *reward = env.reward(end);
    }
}

/// Compiled for each instruction set.
struct Chunks<'a, E, S> {
    env: E,
    states: &'a mut [[S; LANES]],
    actions: &'a [[usize; LANES]],
    terminated: &'a mut [[bool; LANES]],
    inactive: &'a [[bool; LANES]],
}

impl<E: SimdEnv<M, State = S>, S: Copy + From<[f64; M]> + Into<[f64; M]>, const M: usize> pulp::NullaryFnOnce
    for Chunks<'_, E, S>
where
    E: Env<Observation = [f32; M]>,
{
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let env = self.env;
        let places = self.states.iter_mut().zip(self.terminated);
        for ((states, terminated), (actions, inactive)) in places.zip(self.actions.iter().zip(self.inactive)) {
            let actions = std::array::from_fn(|lane| if inactive[lane] { 0 } else { actions[lane] });
            let mut fields = [[0.0; LANES]; M];
            (0..LANES).for_each(|lane| scatter(&mut fields, lane, states[lane]));
            *terminated = env.step_soa(&mut fields, &actions);
            for lane in (0..LANES).filter(|&lane| !inactive[lane]) {
                states[lane] = gather(&fields, lane);
            }
        }
    }
}

/// Puts a state in its lane.
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

/// The state of a lane.
#[inline(always)]
pub(crate) fn gather<S: From<[f64; M]>, const K: usize, const M: usize>(fields: &[[f64; K]; M], lane: usize) -> S {
    std::array::from_fn(|field| fields[field][lane]).into()
}
