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
    fn step_soa<const FUSED: bool, const K: usize>(
        &self,
        fields: &mut [[f64; K]; M],
        actions: &[usize; K],
    ) -> [bool; K];

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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::envs::classic_control::{CartPole, MountainCar};

    /// Steps one chunk with plain and with the widest instructions, and each active state alone.
    fn check<E, const M: usize>(env: E, states: [[f64; M]; LANES], actions: [usize; LANES], inactive: [bool; LANES])
    where
        E: SimdEnv<M> + Env<Observation = [f32; M], State: std::fmt::Debug + PartialEq>,
    {
        for level in [SimdLevel::PLAIN, SimdLevel::detect()] {
            let (mut stepped, mut terminated) = ([states.map(E::State::from)], [[false; LANES]]);
            let (actions, inactive) = (&[actions], &[inactive]);
            level.run(Chunks { env, states: &mut stepped, actions, terminated: &mut terminated, inactive });
            for lane in 0..LANES {
                if inactive[0][lane] {
                    assert_eq!(stepped[0][lane], states[lane].into());
                    continue;
                }
                let step = env.step(states[lane].into(), actions[0][lane], &mut NoRng);
                assert_eq!((stepped[0][lane], terminated[0][lane]), (step.state, step.terminated), "{level:?}");
            }
        }
    }

    proptest! {
        #[test]
        fn chunks_step_as_single_environments(
            cars in prop::array::uniform8(prop_oneof![(-1.2..0.6, -0.07..0.07), (0.45..0.6, 0.0..0.07), (-5.0..5.0, -1.0..1.0)]),
            poles in prop::array::uniform8(prop::array::uniform4(-3.0..3.0)),
            actions in prop::array::uniform8(0_usize..2),
            inactive in prop_oneof![Just([false; LANES]), prop::array::uniform8(any::<bool>())],
        ) {
            check(MountainCar::default(), cars.map(|(position, velocity)| [position, velocity]), actions, inactive);
            check(MountainCar::default(), [[-0.5, 0.01]; LANES], actions.map(|action| 2 * action), inactive);
            check(CartPole::default(), poles, actions, inactive);
        }
    }
}
