//! `MountainCar` in SIMD lanes: the operations of `MountainCar::transition` in the same order.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]
#![expect(clippy::needless_bitwise_bool, reason = "a lazy operator would be an unpredictable branch")]

use super::MountainCar;
use super::mountain_car::{DIRECTIONS, REWARD};
use crate::envs::SimdEnv;
use crate::numeric::cosine;

impl SimdEnv<2> for MountainCar {
    /// The accelerations must be finite: infinite ones can cancel to NaN, and `map_cos` needs finite angles.
    fn is_exact(&self) -> bool {
        cosine::is_exact() && self.force.is_finite() && self.gravity.is_finite()
    }

    #[inline(always)]
    fn step_soa<const FUSED: bool, const K: usize>(
        &self,
        [position, velocity]: &mut [[f64; K]; 2],
        actions: &[usize; K],
    ) -> [bool; K] {
        let acceleration = actions.map(|action| direction(action) * self.force);
        let angle = position.map(|position| 3.0 * position);
        let before = *velocity;
        cosine::map_cos::<FUSED, K>(
            &angle,
            |lane, cosine| before[lane] + (acceleration[lane] + cosine * (-self.gravity)),
            velocity,
        );
        let mut terminated = [false; K];
        for lane in 0..K {
            let new_velocity = clip(velocity[lane], -self.max_speed, self.max_speed);
            let new_position = clip(position[lane] + new_velocity, self.min_position, self.max_position);
            let absorbed = (new_position == self.min_position) & (new_velocity < 0.0);
            position[lane] = new_position;
            velocity[lane] = if absorbed { 0.0 } else { new_velocity };
            terminated[lane] = (new_position >= self.goal_position) & (velocity[lane] >= self.goal_velocity);
        }
        terminated
    }

    #[inline]
    fn reward(&self, _terminated: bool) -> f64 {
        REWARD
    }
}

/// `DIRECTIONS[action]` without a memory access: 2⁵² + `action` has the action in its low bits.
#[inline(always)]
fn direction(action: usize) -> f64 {
    const TWO_POW_52: f64 = 4_503_599_627_370_496.0;
    debug_assert!(action < DIRECTIONS.len(), "actions are checked before");
    f64::from_bits(TWO_POW_52.to_bits() | action as u64) - (TWO_POW_52 - DIRECTIONS[0])
}

/// `np.clip` without a branch. The value must not be NaN.
#[inline(always)]
fn clip(value: f64, low: f64, high: f64) -> f64 {
    let value = if value < low { low } else { value };
    if value > high { high } else { value }
}
