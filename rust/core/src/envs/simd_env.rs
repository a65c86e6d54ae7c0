//! The trait of environments that step in SIMD lanes.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use super::Env;

/// An environment whose deterministic dynamics can be computed in SIMD lanes. The state is `M` numbers, and the
/// observation is the state in float32.
pub trait SimdEnv<const M: usize>:
    Copy + PartialEq + Env<Action = usize, State: From<[f64; M]> + Into<[f64; M]>, Observation = [f32; M]>
{
    /// Whether `step_soa` has the results of `step` with these parameters on this platform.
    fn is_exact(&self) -> bool;

    /// One step in `K` lanes, in place. `fields` holds the states as a structure of arrays: one array per component.
    /// Returns whether each next state is terminal. `FUSED` is that of the [`SimdLevel`](crate::numeric::SimdLevel) which
    /// the code is compiled for.
    fn step_soa<const FUSED: bool, const K: usize>(
        &self,
        fields: &mut [[f64; K]; M],
        actions: &[usize; K],
    ) -> [bool; K];

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
