//! Many environments at once, in the processor's wide registers: never with other results than one by one.

#![expect(clippy::inline_always, reason = "what is compiled for each instruction set must be inlined to be so")]

use crate::env::Env;
use crate::random::NoDraw;

/// How many environments go together best.
pub(crate) const TOGETHER: usize = 8;

/// Physics of `M` numbers, without chance, computed in many lanes at once. The observation is the state in single
/// precision.
pub trait Wide<const M: usize>:
    Copy + PartialEq + Env<Action = usize, State: From<[f64; M]> + Into<[f64; M]>, Observation = [f32; M]>
{
    /// Whether the lanes' results are those of `step` with these constants, on this machine.
    fn trusted(&self) -> bool;

    /// One step in `K` lanes: their states, field by field, move on. Returns which of them are terminal.
    fn step_fields<const K: usize>(&self, fields: &mut [[f64; K]; M], actions: &[usize; K]) -> [bool; K];

    /// What a step brings that ends there, or not.
    fn reward(&self, terminated: bool) -> f64;
}

/// [`Env::step_lanes`], for wide physics.
pub(super) fn step_lanes<E: Wide<M>, const M: usize>(
    env: &E,
    states: &mut [E::State],
    actions: &[usize],
    rewards: &mut [f64],
    terminated: &mut [bool],
    idle: &[bool],
) {
    let together = if env.trusted() { states.len() / TOGETHER * TOGETHER } else { 0 };
    let (wide, rest) = states.split_at_mut(together);
    if together > 0 {
        let (states, actions) = (wide.as_chunks_mut().0, actions.as_chunks().0);
        let (terminated, idle) = (terminated.as_chunks_mut().0, idle.as_chunks().0);
        pulp::Arch::new().dispatch(Chunks { env: *env, states, actions, terminated, idle });
    }
    for (lane, state) in (together..).zip(rest).filter(|(lane, _)| !idle[*lane]) {
        let step = env.step(*state, actions[lane], &mut NoDraw);
        (*state, terminated[lane]) = (step.state, step.terminated);
    }
    for (reward, &end) in rewards.iter_mut().zip(&*terminated) {
        *reward = env.reward(end);
    }
}

/// Compiled for each instruction set.
struct Chunks<'a, E, S> {
    env: E,
    states: &'a mut [[S; TOGETHER]],
    actions: &'a [[usize; TOGETHER]],
    terminated: &'a mut [[bool; TOGETHER]],
    idle: &'a [[bool; TOGETHER]],
}

impl<E: Wide<M, State = S>, S: Copy + From<[f64; M]> + Into<[f64; M]>, const M: usize> pulp::NullaryFnOnce
    for Chunks<'_, E, S>
where
    E: Env<Observation = [f32; M]>,
{
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let env = self.env;
        let places = self.states.iter_mut().zip(self.terminated);
        for ((states, terminated), (actions, idle)) in places.zip(self.actions.iter().zip(self.idle)) {
            let actions = std::array::from_fn(|lane| if idle[lane] { 0 } else { actions[lane] });
            let mut fields = [[0.0; TOGETHER]; M];
            (0..TOGETHER).for_each(|lane| put(&mut fields, lane, states[lane]));
            *terminated = env.step_fields(&mut fields, &actions);
            for lane in (0..TOGETHER).filter(|&lane| !idle[lane]) {
                states[lane] = get(&fields, lane);
            }
        }
    }
}

/// Puts a state in its lane.
#[inline(always)]
pub(crate) fn put<S: Into<[f64; M]>, const K: usize, const M: usize>(
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
pub(crate) fn get<S: From<[f64; M]>, const K: usize, const M: usize>(fields: &[[f64; K]; M], lane: usize) -> S {
    std::array::from_fn(|field| fields[field][lane]).into()
}
