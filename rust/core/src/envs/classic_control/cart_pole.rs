//! `CartPole-v1`: balance a pole on a cart by pushing the cart left or right (A. Barto, R. Sutton and C. Anderson,
//! 1983). Gymnasium's dynamics follow R. Florian, "Correct equations for the dynamics of the cart-pole system", 2005.

use crate::envs::simd_env::sealed::Sealed;
use crate::envs::{Env, Flag, Parameters, SimdEnv, Step, parameters};
use crate::numeric::cos_sin;
use crate::persist_struct;
use crate::random::Rng;
use crate::simd::{F64s, Mask, Portable, Simd, U64s};

/// The bounds of each component of the initial state, which is uniform.
const RESET_BOUNDS: [(&str, f64); 2] = [("low", -0.05), ("high", 0.05)];

/// The parameters, with Gymnasium's names. `total_mass` and `polemass_length` are separate parameters, as in Gymnasium:
/// assigning to `masspole` later does not change them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CartPole {
    /// The acceleration by gravity, in m/s².
    pub gravity: f64,
    /// The mass of the pole.
    pub masspole: f64,
    /// The mass of cart and pole together.
    pub total_mass: f64,
    /// Half the length of the pole.
    pub length: f64,
    /// `masspole * length`.
    pub polemass_length: f64,
    /// The magnitude of the force of a push.
    pub force_mag: f64,
    /// The time step, in seconds.
    pub tau: f64,
    /// An episode ends when the angle exceeds this in either direction.
    pub theta_threshold_radians: f64,
    /// An episode ends when the position exceeds this in either direction.
    pub x_threshold: f64,
    /// Explicit Euler integration (Gymnasium's "euler"): positions move with the old velocities. If false,
    /// semi-implicit Euler: positions move with the new velocities.
    pub euler: bool,
    /// The reward is -1 in the last step and 0 before it, as in the book, instead of 1 per step.
    pub sutton_barto_reward: bool,
}

impl Default for CartPole {
    fn default() -> Self {
        Self {
            gravity: 9.8,
            masspole: 0.1,
            total_mass: 0.1 + 1.0,
            length: 0.5,
            polemass_length: 0.1 * 0.5,
            force_mag: 10.0,
            tau: 0.02,
            theta_threshold_radians: 12.0 * 2.0 * std::f64::consts::PI / 360.0,
            x_threshold: 2.4,
            euler: true,
            sutton_barto_reward: false,
        }
    }
}

impl Parameters for CartPole {
    parameters!(
        gravity,
        masspole,
        total_mass,
        length,
        polemass_length,
        force_mag,
        tau,
        theta_threshold_radians,
        x_threshold
    );

    const FLAGS: &'static [Flag] = &[
        Flag { name: "kinematics_integrator", true_value: Some("euler") },
        Flag { name: "_sutton_barto_reward", true_value: None },
    ];

    fn flag(&mut self, name: &str) -> Option<&mut bool> {
        Some(match name {
            "kinematics_integrator" => &mut self.euler,
            "_sutton_barto_reward" => &mut self.sutton_barto_reward,
            _ => return None,
        })
    }
}

/// The state of cart and pole, in float64.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CartPoleState {
    /// The position of the cart.
    pub x: f64,
    /// The velocity of the cart.
    pub x_dot: f64,
    /// The angle of the pole from upright, in radians.
    pub theta: f64,
    /// The angular velocity of the pole.
    pub theta_dot: f64,
}

persist_struct!(CartPoleState { x, x_dot, theta, theta_dot });

impl From<[f64; 4]> for CartPoleState {
    fn from([x, x_dot, theta, theta_dot]: [f64; 4]) -> Self {
        Self { x, x_dot, theta, theta_dot }
    }
}

impl From<CartPoleState> for [f64; 4] {
    fn from(state: CartPoleState) -> Self {
        [state.x, state.x_dot, state.theta, state.theta_dot]
    }
}

impl CartPole {
    #[inline]
    fn force(&self, action: usize) -> f64 {
        if action == 1 { self.force_mag } else { -self.force_mag }
    }

    /// One step of `K` cart-poles, in place, given the cosine and sine of their angles. Returns whether each next state
    /// is terminal.
    #[inline(always)]
    fn transition<S: Simd, const K: usize>(
        &self,
        simd: S,
        [x, x_dot, theta, theta_dot]: &mut [F64s<S, K>; 4],
        force: F64s<S, K>,
        [costheta, sintheta]: [F64s<S, K>; 2],
    ) -> Mask<S, K> {
        let (old_x_dot, old_theta_dot) = (*x_dot, *theta_dot);
        // Done before the divisions, so that the next angle need not wait for them.
        if self.euler {
            *x = *x + self.tau * old_x_dot;
            *theta = *theta + self.tau * old_theta_dot;
        }
        let temp = (force + self.polemass_length * (old_theta_dot * old_theta_dot) * sintheta) / self.total_mass;
        let four_thirds = F64s::splat(simd, 4.0 / 3.0);
        let thetaacc = (self.gravity * sintheta - costheta * temp)
            / (self.length * (four_thirds - self.masspole * (costheta * costheta) / self.total_mass));
        let xacc = temp - self.polemass_length * thetaacc * costheta / self.total_mass;

        *x_dot = old_x_dot + self.tau * xacc;
        *theta_dot = old_theta_dot + self.tau * thetaacc;
        if !self.euler {
            *x = *x + self.tau * *x_dot;
            *theta = *theta + self.tau * *theta_dot;
        }
        x.less(-self.x_threshold)
            | x.greater(self.x_threshold)
            | theta.less(-self.theta_threshold_radians)
            | theta.greater(self.theta_threshold_radians)
    }
}

impl Env for CartPole {
    type State = CartPoleState;
    type Action = usize;
    type Observation = [f32; 4];

    #[inline]
    fn num_actions(&self) -> usize {
        2
    }

    const RESET_BOUNDS: Option<[(&'static str, f64); 2]> = Some(RESET_BOUNDS);

    #[inline]
    fn reset(&self, rng: &mut impl Rng) -> CartPoleState {
        self.reset_within(RESET_BOUNDS.map(|(_, number)| number), rng)
    }

    #[inline]
    fn reset_within(&self, [low, high]: [f64; 2], rng: &mut impl Rng) -> CartPoleState {
        [(); 4].map(|()| rng.uniform(low, high)).into()
    }

    /// The reward is that of an unfinished episode. The caller handles steps after a terminal state, which Gymnasium
    /// rewards differently.
    #[expect(clippy::inline_always, reason = "a call per step would take a tenth of its time")]
    #[inline(always)]
    fn step(&self, state: CartPoleState, action: usize, _rng: &mut impl Rng) -> Step<CartPoleState> {
        let simd = Portable;
        let mut fields = <[f64; 4]>::from(state).map(|number| F64s::new(simd, [number]));
        let trigonometry = [state.theta.cos(), state.theta.sin()].map(|number| F64s::new(simd, [number]));
        let force = F64s::new(simd, [self.force(action)]);
        let [terminated] = self.transition(simd, &mut fields, force, trigonometry).to_array();
        Step { state: fields.map(|field| field.to_array()[0]).into(), reward: self.reward(terminated), terminated }
    }

    #[inline]
    fn observe(&self, state: &CartPoleState) -> [f32; 4] {
        [state.x as f32, state.x_dot as f32, state.theta as f32, state.theta_dot as f32]
    }
}

impl Sealed for CartPole {}

impl SimdEnv<4> for CartPole {
    fn is_exact(&self) -> bool {
        true
    }

    #[inline(always)]
    fn step_batch<S: Simd, const K: usize>(
        &self,
        simd: S,
        fields: &mut [F64s<S, K>; 4],
        actions: U64s<S, K>,
    ) -> Mask<S, K> {
        let trigonometry = cos_sin(simd, fields[2]);
        let [left, right] = [0, 1].map(|action| F64s::splat(simd, self.force(action)));
        self.transition(simd, fields, actions.equal(1).select(right, left), trigonometry)
    }

    #[inline]
    fn reward(&self, terminated: bool) -> f64 {
        match (self.sutton_barto_reward, terminated) {
            (false, _) => 1.0,
            (true, false) => 0.0,
            (true, true) => -1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Pcg64, SeedSequence};

    fn step(env: CartPole, state: [f64; 4], action: usize) -> Step<CartPoleState> {
        env.step(state.into(), action, &mut Pcg64::new(&SeedSequence::new(&[0])))
    }

    #[test]
    fn with_explicit_euler_a_push_moves_the_cart_one_step_later() {
        let pushed = step(CartPole::default(), [0.0; 4], 1).state;
        assert_eq!((pushed.x, pushed.theta), (0.0, 0.0));
        assert!(pushed.x_dot > 0.0 && pushed.theta_dot < 0.0);
        let semi_implicit = step(CartPole { euler: false, ..CartPole::default() }, [0.0; 4], 1).state;
        assert!(semi_implicit.x > 0.0 && semi_implicit.theta < 0.0);
    }

    #[test]
    fn left_mirrors_right() {
        let left: [f64; 4] = step(CartPole::default(), [0.1, 0.2, 0.03, 0.4], 0).state.into();
        let right: [f64; 4] = step(CartPole::default(), [-0.1, -0.2, -0.03, -0.4], 1).state.into();
        assert_eq!(left, right.map(|number| -number));
    }

    #[test]
    fn an_episode_ends_beyond_a_threshold() {
        assert!(step(CartPole::default(), [2.4, 1.0, 0.0, 0.0], 1).terminated);
        assert!(step(CartPole::default(), [0.0, 0.0, -0.21, -0.1], 0).terminated);
        assert!(!step(CartPole::default(), [2.3, 0.0, 0.2, 0.0], 0).terminated);
    }

    #[test]
    fn the_books_reward_is_minus_one_in_the_last_step() {
        let env = CartPole { sutton_barto_reward: true, ..CartPole::default() };
        assert_eq!(step(env, [0.0; 4], 0).reward, 0.0);
        assert_eq!(step(env, [3.0, 0.0, 0.0, 0.0], 0).reward, -1.0);
        assert_eq!(step(CartPole::default(), [3.0, 0.0, 0.0, 0.0], 0).reward, 1.0);
    }
}
