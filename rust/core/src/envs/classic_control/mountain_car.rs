//! `MountainCar-v0`: an underpowered car in a sinusoidal valley (A. W. Moore, 1990; Sutton & Barto, Example 10.1).

use crate::envs::{Env, Parameters, Step, parameters};
use crate::numeric::cold_path;
use crate::persist_struct;
use crate::random::Rng;

/// The bounds of the initial position, which is uniform.
pub(crate) const RESET_BOUNDS: [(&str, f64); 2] = [("low", -0.6), ("high", -0.4)];
/// The direction of each action: left, none, right. A lookup is faster than converting the action to a float, and the
/// next step waits for the result.
pub(super) const DIRECTIONS: [f64; 3] = [-1.0, 0.0, 1.0];
/// The reward of every step.
pub(super) const REWARD: f64 = -1.0;

/// The parameters, with Gymnasium's names:
///
/// - `velocity ← clip(velocity + force (action - 1) - gravity cos(3 position), -max_speed, max_speed)`
/// - `position ← clip(position + velocity, min_position, max_position)`
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MountainCar {
    /// The position of the left wall, which absorbs the car's speed.
    pub min_position: f64,
    /// The right end of the track.
    pub max_position: f64,
    /// The maximum speed in both directions.
    pub max_speed: f64,
    /// An episode ends at or beyond this position, with at least the goal velocity.
    pub goal_position: f64,
    /// The minimum velocity at the goal.
    pub goal_velocity: f64,
    /// The acceleration by an action, per step.
    pub force: f64,
    /// The acceleration by gravity on the steepest slope, per step.
    pub gravity: f64,
}

impl Default for MountainCar {
    fn default() -> Self {
        Self {
            min_position: -1.2,
            max_position: 0.6,
            max_speed: 0.07,
            goal_position: 0.5,
            goal_velocity: 0.0,
            force: 0.001,
            gravity: 0.0025,
        }
    }
}

impl Parameters for MountainCar {
    parameters!(min_position, max_position, max_speed, goal_position, goal_velocity, force, gravity);
}

/// Position and velocity, in float64 as in Gymnasium.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MountainCarState {
    /// The position; the bottom of the valley is at -π/6.
    pub position: f64,
    /// The velocity, in position units per step.
    pub velocity: f64,
}

persist_struct!(MountainCarState { position, velocity });

impl From<[f64; 2]> for MountainCarState {
    fn from([position, velocity]: [f64; 2]) -> Self {
        Self { position, velocity }
    }
}

impl From<MountainCarState> for [f64; 2] {
    fn from(state: MountainCarState) -> Self {
        [state.position, state.velocity]
    }
}

impl Env for MountainCar {
    type State = MountainCarState;
    type Action = usize;
    type Observation = [f32; 2];

    #[inline]
    fn num_actions(&self) -> usize {
        DIRECTIONS.len()
    }

    const RESET_BOUNDS: Option<[(&'static str, f64); 2]> = Some(RESET_BOUNDS);

    #[inline]
    fn reset(&self, rng: &mut impl Rng) -> MountainCarState {
        self.reset_within(RESET_BOUNDS.map(|(_, number)| number), rng)
    }

    #[inline]
    fn reset_within(&self, [low, high]: [f64; 2], rng: &mut impl Rng) -> MountainCarState {
        MountainCarState { position: rng.uniform(low, high), velocity: 0.0 }
    }

    #[inline]
    fn step(&self, state: MountainCarState, action: usize, _rng: &mut impl Rng) -> Step<MountainCarState> {
        self.transition(state, action)
    }

    #[inline]
    fn observe(&self, state: &MountainCarState) -> [f32; 2] {
        [state.position as f32, state.velocity as f32]
    }
}

impl MountainCar {
    /// One step. It is deterministic, so it needs no random generator.
    #[inline]
    pub fn transition(&self, state: MountainCarState, action: usize) -> Step<MountainCarState> {
        let MountainCarState { mut position, mut velocity } = state;
        let acceleration = DIRECTIONS[action] * self.force;
        velocity += acceleration + (3.0 * position).cos() * (-self.gravity);
        velocity = clip_by_branches(velocity, -self.max_speed, self.max_speed);
        position += velocity;
        position = clip_by_branches(position, self.min_position, self.max_position);
        if position == self.min_position {
            cold_path();
            if velocity < 0.0 {
                velocity = 0.0;
            }
        }
        Step {
            state: MountainCarState { position, velocity },
            reward: REWARD,
            terminated: position >= self.goal_position && velocity >= self.goal_velocity,
        }
    }
}

/// `np.clip` for values that rarely reach a limit: predicted branches. NaN stays NaN.
#[inline]
fn clip_by_branches(value: f64, low: f64, high: f64) -> f64 {
    let mut clipped = value;
    if clipped < low {
        cold_path();
        clipped = low;
    }
    if clipped > high {
        cold_path();
        clipped = high;
    }
    clipped
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::random::{Pcg64, SeedSequence};

    fn step(position: f64, velocity: f64, action: usize) -> Step<MountainCarState> {
        let mut rng = Pcg64::new(&SeedSequence::new(&[0]));
        MountainCar::default().step(MountainCarState { position, velocity }, action, &mut rng)
    }

    #[test]
    fn the_left_wall_absorbs_speed() {
        assert_eq!(step(-1.19, -0.05, 0).state, MountainCarState { position: -1.2, velocity: 0.0 });
    }

    #[test]
    fn speed_is_limited_both_ways() {
        assert_eq!(step(-0.5, 0.07, 2).state.velocity, 0.07);
        assert_eq!(step(-0.5, -0.07, 0).state.velocity, -0.07);
    }

    #[test]
    fn the_goal_needs_the_goal_velocity() {
        assert!(step(0.49, 0.05, 2).terminated);
        let fast_goal = MountainCar { goal_velocity: 0.06, ..MountainCar::default() };
        let mut rng = Pcg64::new(&SeedSequence::new(&[0]));
        assert!(!fast_goal.step(MountainCarState { position: 0.49, velocity: 0.05 }, 2, &mut rng).terminated);
    }

    #[test]
    fn every_step_has_a_reward_of_minus_one() {
        assert_eq!(step(-0.5, 0.0, 1).reward, -1.0);
    }

    /// A literal translation of Gymnasium's `step`.
    fn gymnasium(car: &MountainCar, mut position: f64, mut velocity: f64, action: usize) -> (f64, f64, bool) {
        let np_clip = |value: f64, low: f64, high: f64| if value.is_nan() { value } else { value.max(low).min(high) };
        velocity += (action as f64 - 1.0) * car.force + (3.0 * position).cos() * (-car.gravity);
        velocity = np_clip(velocity, -car.max_speed, car.max_speed);
        position += velocity;
        position = np_clip(position, car.min_position, car.max_position);
        if position == car.min_position && velocity < 0.0 {
            velocity = 0.0;
        }
        (position, velocity, position >= car.goal_position && velocity >= car.goal_velocity)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn every_step_matches_gymnasium(
            position in prop_oneof![-1.3..0.7, -1.2..-1.13, Just(-1.2), Just(0.6), any::<f64>()],
            velocity in prop_oneof![-0.08..0.08, Just(0.0), Just(-0.0), any::<f64>()],
            action in 0_usize..3,
            force in prop_oneof![Just(0.001), -0.1..0.1],
            gravity in prop_oneof![Just(0.0025), -0.1..0.1],
        ) {
            let car = MountainCar { force, gravity, ..MountainCar::default() };
            let mut rng = Pcg64::new(&SeedSequence::new(&[0]));
            let Step { state, terminated, .. } = car.step(MountainCarState { position, velocity }, action, &mut rng);
            let bits = |(position, velocity, terminated): (f64, f64, bool)| {
                (position.to_bits(), velocity.to_bits(), terminated)
            };
            let expected = gymnasium(&car, position, velocity, action);
            prop_assert!(
                bits((state.position, state.velocity, terminated)) == bits(expected)
                    || expected.0.is_nan() && state.position.is_nan()
            );
        }
    }
}
