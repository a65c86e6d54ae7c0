//! `MountainCar` in SIMD lanes: the operations of `MountainCar::transition` in the same order.

use super::MountainCar;
use super::mountain_car::{DIRECTIONS, REWARD};
use crate::envs::SimdEnv;
use crate::envs::simd_env::sealed::Sealed;
use crate::numeric::cosine;
use crate::simd::{F64s, Mask, Simd, U64s};

impl Sealed for MountainCar {}

impl SimdEnv<2> for MountainCar {
    /// The accelerations must be finite: infinite ones can cancel to NaN, and `map_cos` needs finite angles.
    fn is_exact(&self) -> bool {
        cosine::is_exact() && self.force.is_finite() && self.gravity.is_finite()
    }

    #[inline(always)]
    fn step_batch<S: Simd, const K: usize>(
        &self,
        simd: S,
        [position, velocity]: &mut [F64s<S, K>; 2],
        actions: U64s<S, K>,
    ) -> Mask<S, K> {
        let acceleration = direction(actions) * self.force;
        let before = *velocity;
        let after = |cosine: F64s<S, K>| before + (acceleration + cosine * -self.gravity);
        let new_velocity = cosine::map_cos(simd, 3.0 * *position, after).clip(-self.max_speed, self.max_speed);
        *position = (*position + new_velocity).clip(self.min_position, self.max_position);
        let absorbed = position.equal(self.min_position) & new_velocity.less(0.0);
        *velocity = absorbed.select(F64s::splat(simd, 0.0), new_velocity);
        position.greater_or_equal(self.goal_position) & velocity.greater_or_equal(self.goal_velocity)
    }

    #[inline]
    fn reward(&self, _terminated: bool) -> f64 {
        REWARD
    }
}

/// `DIRECTIONS[action]` without a memory access: 2⁵² + `action` holds the action in its low bits.
#[inline(always)]
fn direction<S: Simd, const K: usize>(actions: U64s<S, K>) -> F64s<S, K> {
    const TWO_POW_52: f64 = 4_503_599_627_370_496.0;
    F64s::from_bits(actions | TWO_POW_52.to_bits()) - (TWO_POW_52 - DIRECTIONS[0])
}
