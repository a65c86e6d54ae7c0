//! Many cars at once, in the processor's wide registers: the operations of `MountainCar::step`, in its order.

#![expect(clippy::inline_always, reason = "what is compiled for each instruction set must be inlined to be so")]
#![expect(clippy::needless_bitwise_bool, reason = "a lazy operator would be a branch that nobody can predict")]

use super::MountainCar;
use super::mountain_car::{DIRECTIONS, REWARD};
use crate::envs::SimdEnv;
use crate::numeric::cosine;

impl SimdEnv<2> for MountainCar {
    /// Infinite accelerations may cancel to NaN, which no wall stops.
    fn is_exact(&self) -> bool {
        cosine::IS_EXACT && self.force.is_finite() && self.gravity.is_finite()
    }

    #[inline(always)]
    fn step_soa<const K: usize>(&self, [position, velocity]: &mut [[f64; K]; 2], actions: &[usize; K]) -> [bool; K] {
        let acceleration = actions.map(|action| DIRECTIONS[action] * self.force);
        let angle = position.map(|position| 3.0 * position);
        let before = *velocity;
        cosine::map_cos(
            &angle,
            |lane, cosine| before[lane] + (acceleration[lane] + cosine * (-self.gravity)),
            velocity,
        );
        let mut terminated = [false; K];
        for lane in 0..K {
            let moved = clip(velocity[lane], -self.max_speed, self.max_speed);
            let place = clip(position[lane] + moved, self.min_position, self.max_position);
            let absorbed = (place == self.min_position) & (moved < 0.0);
            position[lane] = place;
            velocity[lane] = if absorbed { 0.0 } else { moved };
            terminated[lane] = (place >= self.goal_position) & (velocity[lane] >= self.goal_velocity);
        }
        terminated
    }

    #[inline]
    fn reward(&self, _terminated: bool) -> f64 {
        REWARD
    }
}

/// `np.clip` of what is not NaN, without a branch.
#[inline(always)]
fn clip(value: f64, low: f64, high: f64) -> f64 {
    let value = if value < low { low } else { value };
    if value > high { high } else { value }
}
