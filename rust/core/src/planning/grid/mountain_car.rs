//! The grid of `MountainCar`: Sutton & Barto's Figure 10.1 shows the surface.

use super::GridTask;
use crate::envs::classic_control::{MountainCar, MountainCarState};
use crate::envs::{Env, Step};

/// The bounds of the horizon. A time limit below them would only hide routes to the goal, one above them costs time.
const HORIZON_BOUNDS: (f64, f64) = (200.0, 1000.0);

impl GridTask<2> for MountainCar {
    /// With half as many, the routes of the beam search are a tenth of a step longer.
    const POINTS: [usize; 2] = [1441, 561];
    const COARSEST_STRIDE: usize = 16;
    const CONVERGED: f64 = 1e-2;

    fn bounds(&self) -> [(f64, f64); 2] {
        [(self.min_position, self.max_position), (-self.max_speed, self.max_speed)]
    }

    fn num_actions(&self) -> usize {
        Env::num_actions(self)
    }

    fn transition(&self, [position, velocity]: [f64; 2], action: usize) -> Step<[f64; 2]> {
        let step = MountainCar::transition(self, MountainCarState { position, velocity }, action);
        Step { state: [step.state.position, step.state.velocity], reward: step.reward, terminated: step.terminated }
    }

    fn observed(&self, state: [f64; 2]) -> [f64; 2] {
        state.map(|number| f64::from(number as f32))
    }

    /// States from which the goal is not reached within the horizon have the negative of it.
    fn lowest_value(&self, max_steps: u64) -> f64 {
        -(max_steps as f64).clamp(HORIZON_BOUNDS.0, HORIZON_BOUNDS.1)
    }
}
