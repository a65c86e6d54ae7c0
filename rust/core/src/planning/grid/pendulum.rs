//! The grid of `Pendulum`, with some of its torques as actions.

use std::f64::consts::PI;

use super::GridTask;
use crate::envs::classic_control::{Pendulum, PendulumState};
use crate::envs::{Env, Step};
use crate::numeric::Scalar;
use crate::random::NoRng;

/// A pendulum whose actions are equally spaced torques.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PendulumTask {
    /// The environment.
    pub pendulum: Pendulum,
    /// The number of torques, at least 2.
    pub torques: usize,
}

impl PendulumTask {
    /// The torque of an action.
    pub fn torque(&self, action: usize) -> f32 {
        let share = action as f64 / (self.torques - 1) as f64;
        (self.pendulum.max_torque * (2.0 * share - 1.0)) as f32
    }
}

impl GridTask<2> for PendulumTask {
    const POINTS: [usize; 2] = [513, 385];
    const COARSEST_STRIDE: usize = 8;
    const CONVERGED: f64 = 1e-3;

    fn bounds(&self) -> [(f64, f64); 2] {
        [(-PI, PI), (-self.pendulum.max_speed, self.pendulum.max_speed)]
    }

    fn num_actions(&self) -> usize {
        self.torques
    }

    fn transition(&self, state: [f64; 2], action: usize) -> Step<[f64; 2]> {
        let torque = Scalar::Single(self.torque(action));
        let step = self.pendulum.step(PendulumState::from(state), torque, &mut NoRng);
        let [theta, theta_dot] = step.state.into();
        Step { state: [theta.sin().atan2(theta.cos()), theta_dot], reward: step.reward, terminated: step.terminated }
    }

    fn observed(&self, [theta, theta_dot]: [f64; 2]) -> [f64; 2] {
        let [cosine, sine] = [theta.cos(), theta.sin()].map(|number| f64::from(number as f32));
        [sine.atan2(cosine), f64::from(theta_dot as f32)]
    }

    /// The cost of a step hanging down at full speed, in every step.
    fn lowest_value(&self, max_steps: u64) -> f64 {
        let Pendulum { max_speed, max_torque, .. } = self.pendulum;
        -(max_steps as f64) * (PI * PI + 0.1 * max_speed * max_speed + 0.001 * max_torque * max_torque)
    }
}
