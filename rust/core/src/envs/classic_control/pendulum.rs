//! `Pendulum-v1`: swing a pendulum up with a continuous torque and keep it upright.

use std::f64::consts::PI;

use crate::envs::{Env, Parameters, Step, parameters};
use crate::numeric::{Scalar, clip, modulo, squared};
use crate::persist_struct;
use crate::random::Rng;

/// The bounds of the initial angle and angular velocity: each is uniform between the bound and its negative.
const RESET_BOUNDS: [(&str, f64); 2] = [("x_init", PI), ("y_init", 1.0)];

/// The parameters, with Gymnasium's names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pendulum {
    /// The maximum angular speed in both directions.
    pub max_speed: f64,
    /// The maximum torque in both directions.
    pub max_torque: f64,
    /// The time step, in seconds.
    pub dt: f64,
    /// The acceleration by gravity, in m/s².
    pub g: f64,
    /// The mass of the pendulum.
    pub m: f64,
    /// The length of the pendulum.
    pub l: f64,
}

impl Default for Pendulum {
    fn default() -> Self {
        Self { max_speed: 8.0, max_torque: 2.0, dt: 0.05, g: 10.0, m: 1.0, l: 1.0 }
    }
}

impl Parameters for Pendulum {
    parameters!(max_speed, max_torque, dt, g, m, l);
}

/// Angle and angular velocity, in float64.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PendulumState {
    /// The angle from upright in radians. It is not wrapped, so it counts full turns.
    pub theta: f64,
    /// The angular velocity.
    pub theta_dot: f64,
}

persist_struct!(PendulumState { theta, theta_dot });

impl From<[f64; 2]> for PendulumState {
    fn from([theta, theta_dot]: [f64; 2]) -> Self {
        Self { theta, theta_dot }
    }
}

impl From<PendulumState> for [f64; 2] {
    fn from(state: PendulumState) -> Self {
        [state.theta, state.theta_dot]
    }
}

impl Pendulum {
    /// A torque clipped to the maximum, in its dtype.
    #[inline]
    pub fn torque(&self, u: Scalar) -> Scalar {
        match u {
            Scalar::Single(u) => {
                let (low, high) = (-self.max_torque as f32, self.max_torque as f32);
                let raised = if u < low { low } else { u };
                Scalar::Single(if raised > high { high } else { raised })
            }
            Scalar::Python(u) | Scalar::Double(u) => Scalar::Double(clip(u, -self.max_torque, self.max_torque)),
        }
    }
}

impl Env for Pendulum {
    type State = PendulumState;
    /// The torque. Its dtype matters: float32 and float64 torques lead to different numbers.
    type Action = Scalar;
    type Observation = [f32; 3];

    #[inline]
    fn num_actions(&self) -> usize {
        0
    }

    const RESET_BOUNDS: Option<[(&'static str, f64); 2]> = Some(RESET_BOUNDS);

    #[inline]
    fn reset(&self, rng: &mut impl Rng) -> PendulumState {
        self.reset_within(RESET_BOUNDS.map(|(_, number)| number), rng)
    }

    #[inline]
    fn reset_within(&self, [angle, speed]: [f64; 2], rng: &mut impl Rng) -> PendulumState {
        let theta = rng.uniform(-angle, angle);
        PendulumState { theta, theta_dot: rng.uniform(-speed, speed) }
    }

    #[inline]
    fn step(&self, state: PendulumState, u: Scalar, _rng: &mut impl Rng) -> Step<PendulumState> {
        let PendulumState { theta, theta_dot } = state;
        let Self { max_speed, dt, g, m, l, .. } = *self;
        let u = self.torque(u);
        let torque_cost = Scalar::Python(0.001) * u.squared();
        let costs = squared(normalized(theta)) + 0.1 * squared(theta_dot) + f64::from(torque_cost);

        let torque_term = Scalar::Python(3.0 / (m * squared(l))) * u;
        let theta_dot = theta_dot + (3.0 * g / (2.0 * l) * theta.sin() + f64::from(torque_term)) * dt;
        let theta_dot = clip(theta_dot, -max_speed, max_speed);
        Step { state: PendulumState { theta: theta + theta_dot * dt, theta_dot }, reward: -costs, terminated: false }
    }

    #[inline]
    fn observe(&self, state: &PendulumState) -> [f32; 3] {
        [state.theta.cos() as f32, state.theta.sin() as f32, state.theta_dot as f32]
    }
}

/// An angle wrapped to [-π, π).
#[inline]
fn normalized(angle: f64) -> f64 {
    modulo(angle + PI, 2.0 * PI) - PI
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Pcg64, SeedSequence};

    fn step(state: [f64; 2], u: Scalar) -> Step<PendulumState> {
        Pendulum::default().step(state.into(), u, &mut Pcg64::new(&SeedSequence::new(&[0])))
    }

    #[test]
    fn upright_and_at_rest_costs_nothing() {
        assert_eq!(step([0.0, 0.0], Scalar::Single(0.0)).reward, 0.0);
        assert_eq!(step([PI, 0.0], Scalar::Double(0.0)).reward, -(PI * PI));
    }

    #[test]
    fn the_torque_is_clipped_in_its_dtype() {
        assert_eq!(Pendulum::default().torque(Scalar::Single(3.0)), Scalar::Single(2.0));
        assert_eq!(Pendulum::default().torque(Scalar::Double(-3.0)), Scalar::Double(-2.0));
        assert_eq!(step([1.0, 0.5], Scalar::Single(9.0)), step([1.0, 0.5], Scalar::Single(2.0)));
    }

    #[test]
    fn the_speed_is_limited_and_an_episode_never_ends() {
        let fast = step([PI / 2.0, 7.9], Scalar::Single(2.0));
        assert_eq!(fast.state.theta_dot, 8.0);
        assert!(!fast.terminated);
    }

    #[test]
    fn full_turns_are_counted_but_cost_nothing() {
        let turned = step([2.0 * PI, 0.0], Scalar::Single(0.0));
        assert_eq!(turned.reward, 0.0);
        assert!(turned.state.theta > 6.0);
    }
}
