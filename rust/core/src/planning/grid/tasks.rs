//! The properties of an environment that value iteration on a grid needs, and the grids of classic control.

use std::f64::consts::PI;

use crate::envs::classic_control::{
    Acrobot, AcrobotState, CartPole, CartPoleState, MountainCar, MountainCarState, Pendulum, PendulumState,
};
use crate::envs::{Env, Step};
use crate::numeric::Scalar;
use crate::random::NoRng;

/// A deterministic environment whose state is `D` numbers, with a grid over them.
pub trait GridTask<const D: usize>: Copy {
    /// The number of grid points along each axis of the finest grid, minus one, must be divisible by the coarsest
    /// stride.
    const POINTS: [usize; D];
    /// The coarsest grid has only every n-th point for this n, a power of two.
    const COARSEST_STRIDE: usize;
    /// The iteration ends when a sweep changes no value by this much or more.
    const CONVERGED: f64;
    /// The discount γ of the values.
    const DISCOUNT: f64 = 1.0;
    /// The number of actions.
    const ACTIONS: usize;

    /// The range of each axis. A state outside it has the value of the nearest state inside.
    fn bounds(&self) -> [(f64, f64); D];

    /// One step from a state.
    fn transition(&self, state: [f64; D], action: usize) -> Step<[f64; D]>;

    /// The state as shown by its float32 observation.
    fn observed(&self, state: [f64; D]) -> [f64; D] {
        state.map(|number| f64::from(number as f32))
    }

    /// The lowest value of a state, if an episode has at most `max_steps` steps.
    fn lowest_value(&self, max_steps: u64) -> f64;
}

/// The bounds of `MountainCar`'s horizon. A lower one would only hide routes to the goal; a higher one costs time.
const HORIZON_BOUNDS: (f64, f64) = (200.0, 1000.0);

/// Sutton & Barto's Figure 10.1 shows the surface.
impl GridTask<2> for MountainCar {
    /// With half as many points, the routes of the beam search are a tenth of a step longer.
    const POINTS: [usize; 2] = [1441, 561];
    const COARSEST_STRIDE: usize = 16;
    const CONVERGED: f64 = 1e-2;
    const ACTIONS: usize = 3;

    fn bounds(&self) -> [(f64, f64); 2] {
        [(self.min_position, self.max_position), (-self.max_speed, self.max_speed)]
    }

    fn transition(&self, [position, velocity]: [f64; 2], action: usize) -> Step<[f64; 2]> {
        let step = MountainCar::transition(self, MountainCarState { position, velocity }, action);
        Step { state: [step.state.position, step.state.velocity], reward: step.reward, terminated: step.terminated }
    }

    /// States from which the goal is not reached within the horizon have minus the horizon as their value.
    fn lowest_value(&self, max_steps: u64) -> f64 {
        -(max_steps as f64).clamp(HORIZON_BOUNDS.0, HORIZON_BOUNDS.1)
    }
}

/// The largest speeds of `CartPole`'s grid, for the cart and for the pole.
const CART_POLE_SPEED: f64 = 3.0;

impl GridTask<4> for CartPole {
    const POINTS: [usize; 4] = [17, 17, 17, 17];
    const COARSEST_STRIDE: usize = 4;
    const CONVERGED: f64 = 1e-3;
    /// Without a discount, all policies that never fall would be equally good.
    const DISCOUNT: f64 = 0.99;
    const ACTIONS: usize = 2;

    fn bounds(&self) -> [(f64, f64); 4] {
        let (x, theta) = (self.x_threshold, self.theta_threshold_radians);
        let speeds = (-CART_POLE_SPEED, CART_POLE_SPEED);
        [(-x, x), speeds, (-theta, theta), speeds]
    }

    fn transition(&self, state: [f64; 4], action: usize) -> Step<[f64; 4]> {
        let step = self.step(CartPoleState::from(state), action, &mut NoRng);
        Step { state: step.state.into(), reward: step.reward, terminated: step.terminated }
    }

    /// The reward of the step that ends an episode at once.
    fn lowest_value(&self, _max_steps: u64) -> f64 {
        if self.sutton_barto_reward { -1.0 } else { 1.0 }
    }
}

/// The largest speeds of `Acrobot`'s grid. Swinging up needs lower speeds.
const ACROBOT_SPEEDS: [f64; 2] = [5.0, 8.0];

impl GridTask<4> for Acrobot {
    const POINTS: [usize; 4] = [33, 33, 33, 33];
    const COARSEST_STRIDE: usize = 4;
    const CONVERGED: f64 = 1e-2;
    const ACTIONS: usize = 3;

    fn bounds(&self) -> [(f64, f64); 4] {
        let [first, second] = [ACROBOT_SPEEDS[0].min(self.max_vel_1), ACROBOT_SPEEDS[1].min(self.max_vel_2)];
        [(-PI, PI), (-PI, PI), (-first, first), (-second, second)]
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

/// The actions are equally spaced torques.
impl GridTask<2> for Pendulum {
    const POINTS: [usize; 2] = [513, 385];
    const COARSEST_STRIDE: usize = 8;
    const CONVERGED: f64 = 1e-3;
    const ACTIONS: usize = 21;

    fn bounds(&self) -> [(f64, f64); 2] {
        [(-PI, PI), (-self.max_speed, self.max_speed)]
    }

    fn transition(&self, state: [f64; 2], action: usize) -> Step<[f64; 2]> {
        let torque = Scalar::Single(grid_torque(self, action));
        let step = self.step(PendulumState::from(state), torque, &mut NoRng);
        let [theta, theta_dot] = step.state.into();
        Step { state: [theta.sin().atan2(theta.cos()), theta_dot], reward: step.reward, terminated: step.terminated }
    }

    fn observed(&self, [theta, theta_dot]: [f64; 2]) -> [f64; 2] {
        let [cosine, sine] = [theta.cos(), theta.sin()].map(|number| f64::from(number as f32));
        [sine.atan2(cosine), f64::from(theta_dot as f32)]
    }

    /// The cost of hanging down at full speed, in every step.
    fn lowest_value(&self, max_steps: u64) -> f64 {
        let Pendulum { max_speed, max_torque, .. } = self;
        -(max_steps as f64) * (PI * PI + 0.1 * max_speed * max_speed + 0.001 * max_torque * max_torque)
    }
}

/// The torque of an action on the grid of a pendulum.
pub fn grid_torque(pendulum: &Pendulum, action: usize) -> f32 {
    let share = action as f64 / (<Pendulum as GridTask<2>>::ACTIONS - 1) as f64;
    (pendulum.max_torque * (2.0 * share - 1.0)) as f32
}
