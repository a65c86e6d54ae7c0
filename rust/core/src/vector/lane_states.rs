//! States that are stepped in SIMD lanes.

use super::{States, StepBuffers};
use crate::StopFlag;
use crate::envs::{Env, SimdEnv};
use crate::memory::{AllocationError, filled};
use crate::random::{NoRng, Rng};
use crate::simd::{F64s, LANES, Simd, SimdCode, SimdLevel, U64s};

/// States of `M` numbers in blocks of [`LANES`] states. Each block is a structure of arrays. The last block may have
/// unused lanes.
#[derive(Clone, Debug)]
pub struct LaneStates<const M: usize>(Vec<[[f64; LANES]; M]>);

impl<E: SimdEnv<M>, const M: usize> States<E> for LaneStates<M>
where
    E: Env<Observation = [f32; M]>,
{
    fn new(state: E::State, size: usize) -> Result<Self, AllocationError> {
        let block = state.into().map(|number| [number; LANES]);
        filled(&block, size.div_ceil(LANES), &StopFlag::new()).map(Self)
    }

    fn get(&self, index: usize) -> E::State {
        let block = &self.0[index / LANES];
        std::array::from_fn(|field| block[field][index % LANES]).into()
    }

    fn set(&mut self, index: usize, state: E::State) {
        for (field, number) in self.0[index / LANES].iter_mut().zip(state.into()) {
            field[index % LANES] = number;
        }
    }

    /// Inactive states are stepped as well, which is harmless because a step draws no random numbers.
    fn step(
        &mut self,
        env: &E,
        actions: &[usize],
        _rngs: &mut [impl Rng],
        _inactive: &[bool],
        buffers: &mut StepBuffers<'_, [f32; M]>,
    ) {
        let StepBuffers { observations, rewards, terminated, .. } = buffers;
        let in_lanes = if env.is_exact() { actions.len() / LANES * LANES } else { 0 };
        SimdLevel::detect().run(Blocks {
            env: *env,
            states: &mut self.0,
            actions: actions[..in_lanes].as_chunks().0,
            observations: observations[..in_lanes].as_chunks_mut().0,
            rewards: rewards[..in_lanes].as_chunks_mut().0,
            terminated: terminated[..in_lanes].as_chunks_mut().0,
        });
        for index in in_lanes..actions.len() {
            let step = env.step(States::<E>::get(self, index), actions[index], &mut NoRng);
            (rewards[index], terminated[index]) = (step.reward, step.terminated);
            observations[index] = env.observe(&step.state);
            States::<E>::set(self, index, step.state);
        }
    }
}

/// Blocks of sub-environments, compiled for each [`SimdLevel`].
struct Blocks<'a, E, const M: usize> {
    env: E,
    states: &'a mut [[[f64; LANES]; M]],
    actions: &'a [[usize; LANES]],
    observations: &'a mut [[[f32; M]; LANES]],
    rewards: &'a mut [[f64; LANES]],
    terminated: &'a mut [[bool; LANES]],
}

impl<E: SimdEnv<M>, const M: usize> SimdCode for Blocks<'_, E, M>
where
    E: Env<Observation = [f32; M]>,
{
    const USES_AVX512: bool = true;

    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let inputs = self.states.iter_mut().zip(self.actions);
        let outputs = self.observations.iter_mut().zip(self.rewards).zip(self.terminated);
        for ((state, actions), ((observations, rewards), terminated)) in inputs.zip(outputs) {
            let mut fields = state.map(|field| F64s::new(simd, field));
            let actions = U64s::new(simd, actions.map(|action| action as u64));
            *terminated = self.env.step_batch(simd, &mut fields, actions).to_array();
            *state = fields.map(F64s::to_array);
            *rewards = terminated.map(|terminated| self.env.reward(terminated));
            let numbers = fields.map(|field| field.to_f32s().to_array());
            for (lane, observation) in observations.iter_mut().enumerate() {
                *observation = numbers.map(|field| field[lane]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::envs::classic_control::{CartPole, MountainCar};

    /// Steps one block with plain instructions and with the widest ones, and each state alone.
    fn check<E, const M: usize>(env: E, states: [[f64; M]; LANES], actions: [usize; LANES])
    where
        E: SimdEnv<M> + Env<Observation = [f32; M], State: std::fmt::Debug + PartialEq>,
    {
        for level in SimdLevel::available() {
            let mut stepped = LaneStates::<M>(vec![[[0.0; LANES]; M]]);
            (0..LANES).for_each(|lane| States::<E>::set(&mut stepped, lane, states[lane].into()));
            let (mut observations, mut rewards, mut terminated) =
                ([[[0.0; M]; LANES]], [[0.0; LANES]], [[false; LANES]]);
            level.run(Blocks {
                env,
                states: &mut stepped.0,
                actions: &[actions],
                observations: &mut observations,
                rewards: &mut rewards,
                terminated: &mut terminated,
            });
            for lane in 0..LANES {
                let step = env.step(states[lane].into(), actions[lane], &mut NoRng);
                assert_eq!(States::<E>::get(&stepped, lane), step.state, "{level:?}");
                assert_eq!(observations[0][lane], env.observe(&step.state));
                assert_eq!((rewards[0][lane], terminated[0][lane]), (step.reward, step.terminated));
            }
        }
    }

    proptest! {
        #[test]
        fn blocks_step_as_single_environments(
            cars in prop::array::uniform8(prop_oneof![(-1.2..0.6, -0.07..0.07), (0.45..0.6, 0.0..0.07), (-5.0..5.0, -1.0..1.0)]),
            poles in prop::array::uniform8(prop_oneof![
                prop::array::uniform4(-0.25..0.25),
                prop::array::uniform4(-3.0..3.0),
            ]),
            actions in prop::array::uniform8(0_usize..2),
            (euler, sutton_barto_reward) in any::<(bool, bool)>(),
        ) {
            check(MountainCar::default(), cars.map(|(position, velocity)| [position, velocity]), actions);
            check(MountainCar::default(), [[-0.5, 0.01]; LANES], actions.map(|action| 2 * action));
            check(CartPole { euler, sutton_barto_reward, ..CartPole::default() }, poles, actions);
        }
    }
}
