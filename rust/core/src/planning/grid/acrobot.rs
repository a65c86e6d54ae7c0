//! The grid of `Acrobot`.

use std::f64::consts::PI;

use super::GridTask;
use crate::envs::classic_control::{Acrobot, AcrobotState};
use crate::envs::{Env, Step};

/// The largest speeds of the grid. Swinging up needs less than these.
const MAX_SPEEDS: [f64; 2] = [5.0, 8.0];

impl GridTask<4> for Acrobot {
    const POINTS: [usize; 4] = [33, 33, 33, 33];
    const COARSEST_STRIDE: usize = 4;
    const CONVERGED: f64 = 1e-2;

    fn bounds(&self) -> [(f64, f64); 4] {
        let [first, second] = [MAX_SPEEDS[0].min(self.max_vel_1), MAX_SPEEDS[1].min(self.max_vel_2)];
        [(-PI, PI), (-PI, PI), (-first, first), (-second, second)]
    }

    fn num_actions(&self) -> usize {
        Env::num_actions(self)
    }

    fn transition(&self, state: [f64; 4], action: usize) -> Step<[f64; 4]> {
        let step = Acrobot::transition(self, AcrobotState::from(state), self.torques[action]);
        Step { state: step.state.into(), reward: step.reward, terminated: step.terminated }
    }

    fn observed(&self, [theta1, theta2, dtheta1, dtheta2]: [f64; 4]) -> [f64; 4] {
        let angle = |theta: f64| f64::from(theta.sin() as f32).atan2(f64::from(theta.cos() as f32));
        [angle(theta1), angle(theta2), f64::from(dtheta1 as f32), f64::from(dtheta2 as f32)]
    }

    fn lowest_value(&self, max_steps: u64) -> f64 {
        -(max_steps as f64)
    }
}
