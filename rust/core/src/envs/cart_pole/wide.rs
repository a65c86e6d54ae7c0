//! Many poles at once: the platform's sine and cosine one by one, the arithmetic in the processor's wide registers.

#![expect(clippy::inline_always, reason = "what is compiled for each instruction set must be inlined to be so")]

use super::{CartPole, CartPoleState};
use crate::env::Env;
use crate::random::NoDraw;

/// How many poles go together best.
const POLES: usize = 8;

/// One step of any number of poles, of which the idle ones stay as they are.
pub(super) fn step_lanes(
    env: &CartPole,
    states: &mut [CartPoleState],
    actions: &[usize],
    terminated: &mut [bool],
    idle: &[bool],
) {
    let (wide, rest) = states.as_chunks_mut();
    let chunked = wide.len() * POLES;
    if chunked > 0 {
        let (actions, idle) = (actions.as_chunks().0, idle.as_chunks().0);
        let terminated = terminated.as_chunks_mut().0;
        pulp::Arch::new().dispatch(Wide { env: *env, states: wide, actions, terminated, idle });
    }
    for (lane, state) in (chunked..).zip(rest).filter(|(lane, _)| !idle[*lane]) {
        let step = env.step(*state, actions[lane], &mut NoDraw);
        (*state, terminated[lane]) = (step.state, step.terminated);
    }
}

/// Compiled for each instruction set.
struct Wide<'a> {
    env: CartPole,
    states: &'a mut [[CartPoleState; POLES]],
    actions: &'a [[usize; POLES]],
    terminated: &'a mut [[bool; POLES]],
    idle: &'a [[bool; POLES]],
}

impl pulp::NullaryFnOnce for Wide<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let env = self.env;
        let places = self.states.iter_mut().zip(self.terminated);
        for ((states, terminated), (actions, idle)) in places.zip(self.actions.iter().zip(self.idle)) {
            // Field by field, as wide registers want it.
            let x = states.map(|state| state.x);
            let x_dot = states.map(|state| state.x_dot);
            let theta = states.map(|state| state.theta);
            let theta_dot = states.map(|state| state.theta_dot);
            let mut fields = [x, x_dot, theta, theta_dot];
            *terminated = env.push(&mut fields, actions.map(|action| env.force(action)));
            for lane in (0..POLES).filter(|&lane| !idle[lane]) {
                states[lane] = fields.map(|field| field[lane]).into();
            }
        }
    }
}
