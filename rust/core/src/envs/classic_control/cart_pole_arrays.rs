//! Many cart-poles whose state is a structure of arrays, as Gymnasium's `CartPoleVectorEnv` holds it.

use super::CartPole;
use crate::envs::SimdEnv;
use crate::numeric::{LANES, SimdCode, SimdLevel};

impl CartPole {
    /// One step of many cart-poles, in place. `state` holds an array for each component. An action is 0 or 1. The results
    /// are those of `step`.
    ///
    /// # Panics
    /// If the arrays differ in length.
    pub fn step_arrays(&self, state: [&mut [f64]; 4], actions: &[i64], terminated: &mut [bool]) {
        let count = actions.len();
        assert!(terminated.len() == count && state.iter().all(|field| field.len() == count), "lengths differ");
        let in_lanes = count / LANES * LANES;
        let [x, x_dot, theta, theta_dot] = state.map(|field| field.split_at_mut(in_lanes));
        let (actions, terminated) = (actions.split_at(in_lanes), terminated.split_at_mut(in_lanes));
        SimdLevel::detect().run(ArrayChunks {
            env: *self,
            state: [x.0, x_dot.0, theta.0, theta_dot.0],
            actions: actions.0,
            terminated: terminated.0,
        });
        for (index, (&action, terminated)) in actions.1.iter().zip(terminated.1).enumerate() {
            let mut fields = [[x.1[index]], [x_dot.1[index]], [theta.1[index]], [theta_dot.1[index]]];
            [*terminated] = self.step_soa::<false, _>(&mut fields, &[action as usize]);
            [[x.1[index]], [x_dot.1[index]], [theta.1[index]], [theta_dot.1[index]]] = fields;
        }
    }
}

/// Cart-poles in chunks of [`LANES`], compiled for each [`SimdLevel`].
struct ArrayChunks<'a> {
    env: CartPole,
    state: [&'a mut [f64]; 4],
    actions: &'a [i64],
    terminated: &'a mut [bool],
}

impl SimdCode for ArrayChunks<'_> {
    type Output = ();

    #[expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]
    #[inline(always)]
    fn run<const FUSED: bool>(self) {
        let [x, x_dot, theta, theta_dot] = self.state.map(|field| field.as_chunks_mut::<LANES>().0);
        let (actions, terminated) = (self.actions.as_chunks::<LANES>().0, self.terminated.as_chunks_mut::<LANES>().0);
        for (index, (actions, terminated)) in actions.iter().zip(terminated).enumerate() {
            let mut fields = [x[index], x_dot[index], theta[index], theta_dot[index]];
            *terminated = self.env.step_soa::<FUSED, _>(&mut fields, &actions.map(|action| action as usize));
            [x[index], x_dot[index], theta[index], theta_dot[index]] = fields;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envs::Env;
    use crate::random::{NoRng, Pcg64, Rng, SeedSequence};

    #[test]
    fn arrays_step_as_single_cart_poles() {
        let mut rng = Pcg64::new(&SeedSequence::new(&[0]));
        let env = CartPole { euler: false, ..CartPole::default() };
        for count in [0, 1, LANES, 3 * LANES + 2] {
            let mut fields = [(); 4].map(|()| (0..count).map(|_| rng.uniform(-1.0, 1.0)).collect::<Vec<_>>());
            let actions: Vec<i64> = (0..count).map(|_| rng.integers(2).into()).collect();
            let before: Vec<[f64; 4]> =
                (0..count).map(|index| std::array::from_fn(|field| fields[field][index])).collect();
            let mut terminated = vec![false; count];
            env.step_arrays(fields.each_mut().map(Vec::as_mut_slice), &actions, &mut terminated);
            for (index, &state) in before.iter().enumerate() {
                let step = env.step(state.into(), actions[index] as usize, &mut NoRng);
                assert_eq!(<[f64; 4]>::from(step.state), std::array::from_fn(|field| fields[field][index]));
                assert_eq!(terminated[index], step.terminated);
            }
        }
    }
}
