//! `Acrobot` with the constants of Gymnasium, and the range of its observations.

use std::f32::consts::PI;

use qtab_core::Env;
use qtab_core::envs::Step;
use qtab_core::envs::classic_control::{Acrobot, AcrobotState};
use qtab_core::numeric::numpy_f32_cos_sin;
use qtab_core::random::Rng;

use super::Bounds;

/// `Acrobot` whose dynamics are compiled once: inlined, they would make the module a tenth larger.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CompactAcrobot(Acrobot);

impl CompactAcrobot {
    /// Of cosine and sine of both angles, and of both angular velocities.
    pub(crate) const BOUNDS: Bounds =
        &[(-1.0, 1.0), (-1.0, 1.0), (-1.0, 1.0), (-1.0, 1.0), (-4.0 * PI, 4.0 * PI), (-9.0 * PI, 9.0 * PI)];

    /// The components that are cosines.
    pub(crate) const COSINES: &[usize] = &[0, 2];

    /// The environment that Gymnasium registers as `Acrobot-v1`, with `NumPy`'s float32 functions after a reset.
    pub(crate) fn v1() -> Self {
        Self(Acrobot { f32_cos_sin: numpy_f32_cos_sin, ..Acrobot::default() })
    }
}

impl Env for CompactAcrobot {
    type State = AcrobotState;
    type Action = usize;
    type Observation = [f32; 6];

    fn num_actions(&self) -> usize {
        self.0.num_actions()
    }

    #[inline(never)]
    fn reset(&self, rng: &mut impl Rng) -> AcrobotState {
        self.0.reset(rng)
    }

    #[inline(never)]
    fn step(&self, state: AcrobotState, action: usize, rng: &mut impl Rng) -> Step<AcrobotState> {
        self.0.step(state, action, rng)
    }

    #[inline(never)]
    fn observe(&self, state: &AcrobotState) -> [f32; 6] {
        self.0.observe(state)
    }
}
