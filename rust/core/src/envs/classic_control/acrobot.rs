//! `Acrobot-v1`: swing up two links by a motor between them (R. Sutton, 1996; Sutton & Barto, 1st ed., section 11.3).

use std::f64::consts::{FRAC_PI_2, PI};

use crate::envs::{Env, Flag, Parameters, Step, parameters};
use crate::numeric::squared;
use crate::persist_struct;
use crate::random::Rng;

/// The bounds of each component of the initial state, which is uniform.
const RESET_BOUNDS: [(&str, f64); 2] = [("low", -0.1), ("high", 0.1)];
const GRAVITY: f64 = 9.8;
/// The largest angle that is wrapped: Gymnasium subtracts full turns one by one. The dynamics never reach it.
const MAX_ANGLE: f64 = 1e6;

/// The parameters, with Gymnasium's names in lower case.
#[derive(Clone, Copy, Debug)]
pub struct Acrobot {
    /// The time step, in seconds.
    pub dt: f64,
    /// The length of the first link.
    pub link_length_1: f64,
    /// The mass of the first link.
    pub link_mass_1: f64,
    /// The mass of the second link.
    pub link_mass_2: f64,
    /// The distance of the first link's centre of mass from its joint.
    pub link_com_pos_1: f64,
    /// The distance of the second link's centre of mass from its joint.
    pub link_com_pos_2: f64,
    /// The moment of inertia of either link.
    pub link_moi: f64,
    /// The maximum angular speed of the first link.
    pub max_vel_1: f64,
    /// The maximum angular speed of the second link.
    pub max_vel_2: f64,
    /// If positive, each torque has uniform noise between this and its negative.
    pub torque_noise_max: f64,
    /// Whether to use the equations of the NIPS paper instead of those of the book.
    pub nips: bool,
    /// The torque of each action.
    pub torques: [f64; 3],
    /// Cosine and sine of a float32 angle, for the observation after a reset. `NumPy` has its own float32 functions,
    /// which differ from the platform's. The default is the platform's.
    pub f32_cos_sin: fn(f32) -> [f32; 2],
}

impl Default for Acrobot {
    fn default() -> Self {
        Self {
            dt: 0.2,
            link_length_1: 1.0,
            link_mass_1: 1.0,
            link_mass_2: 1.0,
            link_com_pos_1: 0.5,
            link_com_pos_2: 0.5,
            link_moi: 1.0,
            max_vel_1: 4.0 * PI,
            max_vel_2: 9.0 * PI,
            torque_noise_max: 0.0,
            nips: false,
            torques: [-1.0, 0.0, 1.0],
            f32_cos_sin: |angle| [angle.cos(), angle.sin()],
        }
    }
}

impl Parameters for Acrobot {
    parameters!(
        "dt" => dt,
        "LINK_LENGTH_1" => link_length_1,
        "LINK_MASS_1" => link_mass_1,
        "LINK_MASS_2" => link_mass_2,
        "LINK_COM_POS_1" => link_com_pos_1,
        "LINK_COM_POS_2" => link_com_pos_2,
        "LINK_MOI" => link_moi,
        "MAX_VEL_1" => max_vel_1,
        "MAX_VEL_2" => max_vel_2,
        "torque_noise_max" => torque_noise_max,
    );

    const FLAGS: &'static [Flag] = &[Flag { name: "book_or_nips", true_value: Some("nips") }];

    fn flag(&mut self, name: &str) -> Option<&mut bool> {
        (name == "book_or_nips").then_some(&mut self.nips)
    }
}

/// The angles and angular velocities of both links: float32 after a reset and float64 after a step, as in Gymnasium.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AcrobotState {
    /// The first link's angle from hanging down, in radians.
    pub theta1: f64,
    /// The second link's angle, relative to the first.
    pub theta2: f64,
    /// The angular velocity of the first link.
    pub dtheta1: f64,
    /// The angular velocity of the second link.
    pub dtheta2: f64,
    /// Whether the state is float32, so that its sines and cosines are computed in float32.
    pub is_f32: bool,
}

persist_struct!(AcrobotState { theta1, theta2, dtheta1, dtheta2, is_f32 });

impl From<[f64; 4]> for AcrobotState {
    fn from([theta1, theta2, dtheta1, dtheta2]: [f64; 4]) -> Self {
        Self { theta1, theta2, dtheta1, dtheta2, is_f32: false }
    }
}

impl From<AcrobotState> for [f64; 4] {
    fn from(state: AcrobotState) -> Self {
        [state.theta1, state.theta2, state.dtheta1, state.dtheta2]
    }
}

impl Acrobot {
    /// One step under a torque that includes the noise.
    #[inline]
    pub fn transition(&self, state: AcrobotState, torque: f64) -> Step<AcrobotState> {
        let derivative = self.dynamics(torque);
        let [theta1, theta2, dtheta1, dtheta2] = runge_kutta(derivative, state.into(), self.dt);
        let theta1 = wrap(theta1);
        let theta2 = wrap(theta2);
        let dtheta1 = bound(dtheta1, self.max_vel_1);
        let dtheta2 = bound(dtheta2, self.max_vel_2);

        let terminated = -theta1.cos() - (theta2 + theta1).cos() > 1.0;
        let reward = if terminated { 0.0 } else { -1.0 };
        Step { state: [theta1, theta2, dtheta1, dtheta2].into(), reward, terminated }
    }

    /// The time derivative of a state, with the names and the order of operations of Gymnasium's source.
    fn dynamics(&self, a: f64) -> impl Fn([f64; 4]) -> [f64; 4] + use<> {
        let (m1, m2, l1, lc1, lc2) =
            (self.link_mass_1, self.link_mass_2, self.link_length_1, self.link_com_pos_1, self.link_com_pos_2);
        let (i1, i2, g, nips) = (self.link_moi, self.link_moi, GRAVITY, self.nips);
        let [link_squared, com1_squared, com2_squared] = [l1, lc1, lc2].map(squared);
        move |[theta1, theta2, dtheta1, dtheta2]| {
            let (sine, cosine) = (theta2.sin(), theta2.cos());
            let d1 = m1 * com1_squared + m2 * (link_squared + com2_squared + 2.0 * l1 * lc2 * cosine) + i1 + i2;
            let d2 = m2 * (com2_squared + l1 * lc2 * cosine) + i2;
            let phi2 = m2 * lc2 * g * (theta1 + theta2 - FRAC_PI_2).cos();
            let phi1 = -m2 * l1 * lc2 * squared(dtheta2) * sine - 2.0 * m2 * l1 * lc2 * dtheta2 * dtheta1 * sine
                + (m1 * lc1 + m2 * l1) * g * (theta1 - FRAC_PI_2).cos()
                + phi2;
            let inertia = m2 * com2_squared + i2 - squared(d2) / d1;
            let ddtheta2 = if nips {
                (a + d2 / d1 * phi1 - phi2) / inertia
            } else {
                (a + d2 / d1 * phi1 - m2 * l1 * lc2 * squared(dtheta1) * sine - phi2) / inertia
            };
            let ddtheta1 = -(d2 * ddtheta2 + phi1) / d1;
            [dtheta1, dtheta2, ddtheta1, ddtheta2]
        }
    }
}

impl Env for Acrobot {
    type State = AcrobotState;
    type Action = usize;
    type Observation = [f32; 6];

    #[inline]
    fn num_actions(&self) -> usize {
        self.torques.len()
    }

    const RESET_BOUNDS: Option<[(&'static str, f64); 2]> = Some(RESET_BOUNDS);

    #[inline]
    fn reset(&self, rng: &mut impl Rng) -> AcrobotState {
        self.reset_within(RESET_BOUNDS.map(|(_, number)| number), rng)
    }

    #[inline]
    fn reset_within(&self, [low, high]: [f64; 2], rng: &mut impl Rng) -> AcrobotState {
        let state = [(); 4].map(|()| f64::from(rng.uniform(low, high) as f32));
        AcrobotState { is_f32: true, ..state.into() }
    }

    #[inline]
    fn step(&self, state: AcrobotState, action: usize, rng: &mut impl Rng) -> Step<AcrobotState> {
        let mut torque = self.torques[action];
        if self.torque_noise_max > 0.0 {
            torque += rng.uniform(-self.torque_noise_max, self.torque_noise_max);
        }
        self.transition(state, torque)
    }

    #[inline]
    fn observe(&self, state: &AcrobotState) -> [f32; 6] {
        let AcrobotState { theta1, theta2, dtheta1, dtheta2, is_f32 } = *state;
        let cos_sin = |theta: f64| {
            if is_f32 { (self.f32_cos_sin)(theta as f32) } else { [theta.cos() as f32, theta.sin() as f32] }
        };
        let ([cos1, sin1], [cos2, sin2]) = (cos_sin(theta1), cos_sin(theta2));
        [cos1, sin1, cos2, sin2, dtheta1 as f32, dtheta2 as f32]
    }
}

/// One step of the classical fourth-order Runge-Kutta method.
#[inline]
fn runge_kutta(derivative: impl Fn([f64; 4]) -> [f64; 4], start: [f64; 4], dt: f64) -> [f64; 4] {
    let half = dt / 2.0;
    let advance = |step: f64, slope: [f64; 4]| std::array::from_fn(|i| start[i] + step * slope[i]);
    let k1 = derivative(start);
    let k2 = derivative(advance(half, k1));
    let k3 = derivative(advance(half, k2));
    let k4 = derivative(advance(dt, k3));
    std::array::from_fn(|i| start[i] + dt / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
}

/// An angle wrapped to [-π, π] by subtracting full turns, as Gymnasium does; NaN above [`MAX_ANGLE`].
#[inline]
fn wrap(mut angle: f64) -> f64 {
    if angle.abs() > MAX_ANGLE {
        return f64::NAN;
    }
    while angle > PI {
        angle -= PI - -PI;
    }
    while angle < -PI {
        angle += PI - -PI;
    }
    angle
}

/// Gymnasium's `bound`: a velocity clipped to the maximum speed in both directions.
#[inline]
fn bound(velocity: f64, max: f64) -> f64 {
    let raised = if -max > velocity { -max } else { velocity };
    if max < raised { max } else { raised }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Pcg64, SeedSequence};

    #[test]
    fn hanging_at_rest_stays_at_rest() {
        let step = Acrobot::default().transition(AcrobotState::default(), 0.0);
        assert!(<[f64; 4]>::from(step.state).iter().all(|number| number.abs() < 1e-15));
        assert_eq!((step.reward, step.terminated), (-1.0, false));
    }

    #[test]
    fn the_last_step_costs_nothing() {
        let step = Acrobot::default().transition([PI, 0.0, 0.0, 0.0].into(), 0.0);
        assert_eq!((step.reward, step.terminated), (0.0, true));
    }

    #[test]
    fn angles_are_wrapped_and_speeds_bounded() {
        let fast: [f64; 4] = Acrobot::default().transition([3.0, 3.0, 12.5, 28.0].into(), 1.0).state.into();
        assert!(fast.iter().zip([PI, PI, 4.0 * PI, 9.0 * PI]).all(|(number, bound)| number.abs() <= bound));
        assert!(wrap(1e300).is_nan());
    }

    #[test]
    fn noise_is_drawn_only_if_enabled() {
        let seed = SeedSequence::new(&[0]);
        let (mut rng, untouched) = (Pcg64::new(&seed), Pcg64::new(&seed));
        let still = Acrobot::default().step(AcrobotState::default(), 1, &mut rng);
        assert_eq!(rng, untouched);
        let noisy = Acrobot { torque_noise_max: 1.0, ..Acrobot::default() };
        assert_ne!(noisy.step(AcrobotState::default(), 1, &mut rng).state, still.state);
        assert_ne!(rng, untouched);
    }

    #[test]
    fn the_observation_after_a_reset_is_computed_in_float32() {
        let env = Acrobot { f32_cos_sin: |_| [0.25, 0.75], ..Acrobot::default() };
        let state = env.reset(&mut Pcg64::new(&SeedSequence::new(&[0])));
        assert_eq!(f64::from(state.theta1 as f32), state.theta1);
        assert_eq!(env.observe(&state)[..2], [0.25, 0.75]);
        assert_eq!(env.observe(&AcrobotState::default())[..2], [1.0, 0.0]);
    }
}
