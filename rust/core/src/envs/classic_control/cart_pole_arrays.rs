//! Many cart-poles whose state is a structure of arrays, as Gymnasium's `CartPoleVectorEnv` stores it.

use super::CartPole;
use crate::envs::SimdEnv;
use crate::simd::{F64s, LANES, Mask, Portable, Simd, SimdCode, SimdLevel, U64s};

impl CartPole {
    /// One step of many cart-poles, in place. `state` has one array per component. An action is 0 or 1. The results are
    /// those of `step`. Returns whether every magnitude was at most `largest` before the step and every number is
    /// finite after it.
    ///
    /// # Panics
    /// If the arrays differ in length.
    #[must_use]
    pub fn step_arrays(&self, state: [&mut [f64]; 4], actions: &[i64], terminated: &mut [bool], largest: f64) -> bool {
        let count = actions.len();
        assert!(terminated.len() == count && state.iter().all(|field| field.len() == count), "lengths differ");
        let in_lanes = count / LANES * LANES;
        let [x, x_dot, theta, theta_dot] = state.map(|field| field.split_at_mut(in_lanes));
        let (actions, terminated) = (actions.split_at(in_lanes), terminated.split_at_mut(in_lanes));
        let mut supported = SimdLevel::detect().run(ArrayChunks {
            env: *self,
            state: [x.0, x_dot.0, theta.0, theta_dot.0],
            actions: actions.0,
            terminated: terminated.0,
            largest,
        });
        for (index, (&action, terminated)) in actions.1.iter().zip(terminated.1).enumerate() {
            let simd = Portable;
            let state = [&mut x.1[index], &mut x_dot.1[index], &mut theta.1[index], &mut theta_dot.1[index]];
            let mut fields = state.each_ref().map(|number| F64s::new(simd, [**number]));
            supported &= !out_of_range(&fields, largest).any();
            [*terminated] = self.step_batch(simd, &mut fields, U64s::new(simd, [action as u64])).to_array();
            supported &= !out_of_range(&fields, f64::MAX).any();
            for (number, field) in state.into_iter().zip(fields) {
                [*number] = field.to_array();
            }
        }
        supported
    }
}

/// The lanes in which the magnitude of a component exceeds the limit or is NaN.
#[inline(always)]
fn out_of_range<S: Simd, const K: usize>(fields: &[F64s<S, K>; 4], limit: f64) -> Mask<S, K> {
    // NaN is not in the range.
    let mut in_range = fields[0].abs().less_or_equal(limit);
    for field in &fields[1..] {
        in_range = in_range & field.abs().less_or_equal(limit);
    }
    !in_range
}

/// Cart-poles in chunks of [`LANES`], compiled for each [`SimdLevel`].
struct ArrayChunks<'a> {
    env: CartPole,
    state: [&'a mut [f64]; 4],
    actions: &'a [i64],
    terminated: &'a mut [bool],
    largest: f64,
}

impl SimdCode for ArrayChunks<'_> {
    const USES_AVX512: bool = true;

    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> bool {
        let [x, x_dot, theta, theta_dot] = self.state.map(|field| field.as_chunks_mut::<LANES>().0);
        let (actions, terminated) = (self.actions.as_chunks::<LANES>().0, self.terminated.as_chunks_mut::<LANES>().0);
        let mut any_out_of_range = Mask::new(simd, [false; LANES]);
        for (index, (actions, terminated)) in actions.iter().zip(terminated).enumerate() {
            let state = [&mut x[index], &mut x_dot[index], &mut theta[index], &mut theta_dot[index]];
            let mut fields = state.each_ref().map(|field| F64s::new(simd, **field));
            any_out_of_range = any_out_of_range | out_of_range(&fields, self.largest);
            let actions = U64s::new(simd, actions.map(|action| action as u64));
            *terminated = self.env.step_batch(simd, &mut fields, actions).to_array();
            any_out_of_range = any_out_of_range | out_of_range(&fields, f64::MAX);
            for (numbers, field) in state.into_iter().zip(fields) {
                *numbers = field.to_array();
            }
        }
        !any_out_of_range.any()
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
            let supported = env.step_arrays(fields.each_mut().map(Vec::as_mut_slice), &actions, &mut terminated, 1.0);
            assert!(supported);
            for (index, &state) in before.iter().enumerate() {
                let step = env.step(state.into(), actions[index] as usize, &mut NoRng);
                assert_eq!(<[f64; 4]>::from(step.state), std::array::from_fn(|field| fields[field][index]));
                assert_eq!(terminated[index], step.terminated);
            }
        }
    }

    #[test]
    fn a_large_number_or_an_infinite_result_is_reported_in_every_place() {
        let env = CartPole { gravity: f64::MAX, length: 0.1, ..CartPole::default() };
        for (lane, field) in (0..=LANES).flat_map(|lane| (0..4).map(move |field| (lane, field))) {
            for (number, largest) in [(1.5, 1.0), (f64::NAN, f64::MAX), (f64::INFINITY, f64::MAX)] {
                let mut fields = [(); 4].map(|()| vec![0.0; LANES + 1]);
                fields[field][lane] = number;
                let state = fields.each_mut().map(Vec::as_mut_slice);
                let terminated = &mut [false; LANES + 1];
                assert!(!CartPole::default().step_arrays(state, &[0; LANES + 1], terminated, largest));
            }
            let mut fields = [(); 4].map(|()| vec![0.0; LANES + 1]);
            fields[2][lane] = 0.2;
            let state = fields.each_mut().map(Vec::as_mut_slice);
            assert!(!env.step_arrays(state, &[0; LANES + 1], &mut [false; LANES + 1], 1.0));
        }
    }
}
