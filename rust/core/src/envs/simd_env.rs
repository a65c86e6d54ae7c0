//! The trait of environments that step in SIMD lanes.

use super::Env;
use crate::simd::{F64s, Mask, Simd, U64s};

/// Closes [`SimdEnv`] to other crates, which cannot compute with numbers in lanes.
pub(in crate::envs) mod sealed {
    pub trait Sealed {}
}

/// An environment of this crate whose deterministic dynamics can be computed in SIMD lanes. The state is `M` numbers,
/// and the observation is the state in float32. Environments of other crates implement [`Env`] alone, which the compiler
/// optimizes with the training loop.
pub trait SimdEnv<const M: usize>:
    sealed::Sealed + Copy + PartialEq + Env<Action = usize, State: From<[f64; M]> + Into<[f64; M]>, Observation = [f32; M]>
{
    /// Whether `step_batch` gives the results of `step` with these parameters on this platform.
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
