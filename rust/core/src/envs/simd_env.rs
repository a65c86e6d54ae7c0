//! The trait of environments that step in SIMD lanes.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use super::Env;
use crate::simd::{F64s, Mask, Simd, U64s};

/// An environment whose deterministic dynamics can be computed in SIMD lanes. The state is `M` numbers, and the
/// observation is the state in float32.
pub trait SimdEnv<const M: usize>:
    Copy + PartialEq + Env<Action = usize, State: From<[f64; M]> + Into<[f64; M]>, Observation = [f32; M]>
{
    /// Whether `step_batch` has the results of `step` with these parameters on this platform.
    fn is_exact(&self) -> bool;

    /// One step in `K` lanes, in place. Returns whether each next state is terminal.
    fn step_batch<S: Simd, const K: usize>(
        &self,
        simd: S,
        fields: &mut [F64s<S, K>; M],
        actions: U64s<S, K>,
    ) -> Mask<S, K>;

    /// The reward of a step, which depends only on whether the next state is terminal.
    fn reward(&self, terminated: bool) -> f64;
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
