//! Many cars at once, in the processor's wide registers: the operations of `MountainCar::step`, in its order.

#![expect(clippy::inline_always, reason = "what is compiled for each instruction set must be inlined to be so")]
#![expect(clippy::needless_bitwise_bool, reason = "a lazy operator would be a branch that nobody can predict")]

use super::{DIRECTIONS, MountainCar, MountainCarState};
use crate::cosine;

/// How many cars go together best.
const CARS: usize = 8;

/// One step of the physics of `K` cars, none of whose numbers is NaN; bits equal the lone car's where the cosine is
/// trusted.
#[inline(always)]
pub(crate) fn drive_all<const K: usize>(
    car: &MountainCar,
    position: &mut [f64; K],
    velocity: &mut [f64; K],
    action: &[usize; K],
) {
    let push = action.map(|action| DIRECTIONS[action] * car.force);
    let angle = position.map(|position| 3.0 * position);
    let before = *velocity;
    cosine::monotone(&angle, |lane, cosine| before[lane] + (push[lane] + cosine * (-car.gravity)), velocity);
    for lane in 0..K {
        let moved = clip(velocity[lane], -car.max_speed, car.max_speed);
        let place = clip(position[lane] + moved, car.min_position, car.max_position);
        let absorbed = (place == car.min_position) & (moved < 0.0);
        position[lane] = place;
        velocity[lane] = if absorbed { 0.0 } else { moved };
    }
}

/// One step of any number of cars, of which the idle ones stay where they are.
pub(super) fn step_lanes(
    car: &MountainCar,
    states: &mut [MountainCarState],
    actions: &[usize],
    terminated: &mut [bool],
    idle: &[bool],
) {
    // Infinite accelerations may cancel to NaN.
    let wide = cosine::TRUSTED && car.force.is_finite() && car.gravity.is_finite();
    let chunked = if wide { states.len() / CARS * CARS } else { 0 };
    let (wide, rest) = states.split_at_mut(chunked);
    if chunked > 0 {
        let (states, actions) = (wide.as_chunks_mut().0, actions.as_chunks().0);
        let (terminated, idle) = (terminated.as_chunks_mut().0, idle.as_chunks().0);
        pulp::Arch::new().dispatch(Wide { car: *car, states, actions, terminated, idle });
    }
    for (lane, state) in (chunked..).zip(rest).filter(|(lane, _)| !idle[*lane]) {
        let step = car.drive(*state, actions[lane]);
        (*state, terminated[lane]) = (step.state, step.terminated);
    }
}

/// Compiled for each instruction set.
struct Wide<'a> {
    car: MountainCar,
    states: &'a mut [[MountainCarState; CARS]],
    actions: &'a [[usize; CARS]],
    terminated: &'a mut [[bool; CARS]],
    idle: &'a [[bool; CARS]],
}

impl pulp::NullaryFnOnce for Wide<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let car = self.car;
        let places = self.states.iter_mut().zip(self.terminated);
        for ((states, terminated), (actions, idle)) in places.zip(self.actions.iter().zip(self.idle)) {
            let actions = std::array::from_fn(|lane| if idle[lane] { 0 } else { actions[lane] });
            let mut position: [f64; CARS] = std::array::from_fn(|lane| states[lane].position);
            let mut velocity: [f64; CARS] = std::array::from_fn(|lane| states[lane].velocity);
            drive_all(&car, &mut position, &mut velocity, &actions);
            for lane in 0..CARS {
                let state = MountainCarState { position: position[lane], velocity: velocity[lane] };
                states[lane] = if idle[lane] { states[lane] } else { state };
                terminated[lane] = (position[lane] >= car.goal_position) & (velocity[lane] >= car.goal_velocity);
            }
        }
    }
}

/// `np.clip` of what is not NaN, without a branch.
#[inline(always)]
fn clip(value: f64, low: f64, high: f64) -> f64 {
    let value = if value < low { low } else { value };
    if value > high { high } else { value }
}
