//! The grid of `CartPole`.

use super::GridTask;
use crate::envs::classic_control::{CartPole, CartPoleState};
use crate::envs::{Env, Step};
use crate::random::NoRng;

/// The largest speeds of the grid, of the cart and of the pole.
const MAX_SPEEDS: [f64; 2] = [3.0, 3.0];

impl GridTask<4> for CartPole {
    const POINTS: [usize; 4] = [17, 17, 17, 17];
    const COARSEST_STRIDE: usize = 4;
    const CONVERGED: f64 = 1e-3;
    /// Without a discount, all policies that never fall would be as good as each other.
    const DISCOUNT: f64 = 0.99;

    fn bounds(&self) -> [(f64, f64); 4] {
        let (x, theta) = (self.x_threshold, self.theta_threshold_radians);
        [(-x, x), (-MAX_SPEEDS[0], MAX_SPEEDS[0]), (-theta, theta), (-MAX_SPEEDS[1], MAX_SPEEDS[1])]
    }

    fn num_actions(&self) -> usize {
        Env::num_actions(self)
    }

    fn transition(&self, state: [f64; 4], action: usize) -> Step<[f64; 4]> {
        let step = self.step(CartPoleState::from(state), action, &mut NoRng);
        Step { state: step.state.into(), reward: step.reward, terminated: step.terminated }
    }

    fn observed(&self, state: [f64; 4]) -> [f64; 4] {
        state.map(|number| f64::from(number as f32))
    }

    /// The reward of the step that ends an episode at once.
    fn lowest_value(&self, _max_steps: u64) -> f64 {
        if self.sutton_barto_reward { -1.0 } else { 1.0 }
    }
}
