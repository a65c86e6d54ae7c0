//! What value iteration on a grid needs to know of an environment.

use crate::envs::Step;

/// A deterministic environment whose state is `D` numbers, with a grid over them.
pub trait GridTask<const D: usize>: Copy {
    /// The number of grid points along each axis of the finest grid. One less must be divisible by the coarsest stride.
    const POINTS: [usize; D];
    /// The coarsest grid has every so many-th point only: a power of two.
    const COARSEST_STRIDE: usize;
    /// The iteration ends when a sweep changes no value by as much.
    const CONVERGED: f64;
    /// The discount γ of the values.
    const DISCOUNT: f64 = 1.0;

    /// The range of each axis. The values of states outside it are those of the nearest one inside.
    fn bounds(&self) -> [(f64, f64); D];

    /// The number of actions.
    fn num_actions(&self) -> usize;

    /// One step from a state.
    fn transition(&self, state: [f64; D], action: usize) -> Step<[f64; D]>;

    /// The state as far as its float32 observation shows it.
    fn observed(&self, state: [f64; D]) -> [f64; D];

    /// The lowest value of a state, where an episode has at most `max_steps` steps.
    fn lowest_value(&self, max_steps: u64) -> f64;
}
