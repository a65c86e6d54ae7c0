//! The racetrack (Sutton & Barto, Exercise 5.12 and Figure 5.5).
//!
//! A car drives over a grid. Its velocity has two components, upwards and to the right, each from 0 to 4 cells per
//! step. An action changes each of them by -1, 0 or +1. The reward is -1 per step until the car crosses the finish
//! line. A car that leaves the track returns to a random cell of the starting line, with a velocity of zero.

use std::sync::Arc;

use crate::envs::{Env, Step};
use crate::random::Rng;

/// The number of velocities per component.
const VELOCITIES: u32 = 5;
/// The number of actions: an acceleration of -1, 0 or +1 for each component.
const NUM_ACTIONS: usize = 9;

/// The kind of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ground {
    /// Not on the track.
    Off,
    /// The track.
    Track,
    /// The starting line.
    Start,
    /// The finish line.
    Finish,
}

/// A racetrack.
#[derive(Clone, Debug, PartialEq)]
pub struct Racetrack {
    /// The cells, row by row from the top.
    ground: Arc<[Ground]>,
    columns: u32,
    /// The cells of the starting line.
    starts: Arc<[u32]>,
    /// The probability that an action has no effect.
    failure: f64,
}

impl Racetrack {
    /// A track of these cells, row by row from the top; `None` if they do not form a rectangle or have no starting
    /// line.
    pub fn new(ground: &[Ground], columns: u32, failure: f64) -> Option<Self> {
        let starts: Vec<u32> =
            (0..).zip(ground).filter(|(_, cell)| **cell == Ground::Start).map(|(at, _)| at).collect();
        let fits = u32::try_from(ground.len()).is_ok_and(|cells| cells < u32::MAX / (VELOCITIES * VELOCITIES));
        let valid = columns > 0 && ground.len().is_multiple_of(columns as usize) && !starts.is_empty() && fits;
        valid.then(|| Self { ground: ground.into(), columns, starts: starts.into(), failure })
    }

    /// The number of states: a cell and two velocities.
    pub fn num_states(&self) -> u32 {
        self.ground.len() as u32 * VELOCITIES * VELOCITIES
    }

    /// A cell of the starting line, with a velocity of zero.
    #[inline]
    fn start(&self, rng: &mut impl Rng) -> u32 {
        self.starts[rng.integers(self.starts.len() as u32) as usize] * VELOCITIES * VELOCITIES
    }

    /// The cell that the car reaches from a cell with these velocities; `None` if the car leaves the track. The path is
    /// a straight line, sampled once per cell of its longer side and rounded to the nearest cell.
    fn cell_reached(&self, cell: u32, up: u32, right: u32) -> Option<(u32, bool)> {
        let (row, column, steps) = (cell / self.columns, cell % self.columns, up.max(right));
        let mut reached = cell;
        for step in 1..=steps {
            // Halves round up.
            let along = |velocity: u32| (2 * step * velocity + steps) / (2 * steps);
            let (row, column) = (row.checked_sub(along(up))?, column + along(right));
            if column >= self.columns {
                return None;
            }
            reached = row * self.columns + column;
            match self.ground[reached as usize] {
                Ground::Off => return None,
                Ground::Finish => return Some((reached, true)),
                Ground::Track | Ground::Start => {}
            }
        }
        Some((reached, false))
    }
}

impl Env for Racetrack {
    /// ((row · columns + column) · 5 + velocity upwards) · 5 + velocity to the right.
    type State = u32;
    type Action = usize;
    type Observation = u32;

    #[inline]
    fn num_actions(&self) -> usize {
        NUM_ACTIONS
    }

    #[inline]
    fn reset(&self, rng: &mut impl Rng) -> u32 {
        self.start(rng)
    }

    /// Draws one `random()`, then one `integers` if the car leaves the track.
    fn step(&self, state: u32, action: usize, rng: &mut impl Rng) -> Step<u32> {
        assert!(action < NUM_ACTIONS, "action must be less than {NUM_ACTIONS}, got {action}");
        let (cell, up, right) =
            (state / (VELOCITIES * VELOCITIES), state / VELOCITIES % VELOCITIES, state % VELOCITIES);
        let fails = rng.random() < self.failure;
        // The actions encode the accelerations -1, 0 and +1 as 0, 1 and 2.
        let changed =
            |velocity: u32, acceleration: usize| (velocity + acceleration as u32).saturating_sub(1).min(VELOCITIES - 1);
        let wanted = if fails { (up, right) } else { (changed(up, action / 3), changed(right, action % 3)) };
        // The velocity may be zero only on the starting line.
        let stands = wanted == (0, 0) && self.ground[cell as usize] != Ground::Start;
        let (up, right) = if stands { (up, right) } else { wanted };
        let (state, terminated) = match self.cell_reached(cell, up, right) {
            Some((cell, finished)) => ((cell * VELOCITIES + up) * VELOCITIES + right, finished),
            None => (self.start(rng), false),
        };
        Step { state, reward: -1.0, terminated }
    }

    #[inline]
    fn observe(&self, &state: &u32) -> u32 {
        state
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Pcg64, SeedSequence};

    /// A corridor of four cells with the finish at its top, one cell of starting line below.
    fn corridor() -> Racetrack {
        let ground = [Ground::Finish, Ground::Track, Ground::Track, Ground::Track, Ground::Start];
        Racetrack::new(&ground, 1, 0.0).expect("a track")
    }

    #[test]
    fn the_finish_is_crossed_on_the_way() {
        let (track, mut rng) = (corridor(), Pcg64::new(&SeedSequence::new(&[0])));
        let start = track.reset(&mut rng);
        assert_eq!(start, 4 * 25);
        // Up by 1, then by 2, then by 3, where only one cell is left.
        let first = track.step(start, 7, &mut rng);
        let second = track.step(first.state, 7, &mut rng);
        assert_eq!((first.state, second.state), (3 * 25 + 5, 25 + 10));
        let last = track.step(second.state, 7, &mut rng);
        assert_eq!((last.state, last.reward, last.terminated), (15, -1.0, true));
    }

    #[test]
    fn a_car_that_leaves_the_track_begins_again() {
        let (track, mut rng) = (corridor(), Pcg64::new(&SeedSequence::new(&[0])));
        let off = track.step(3 * 25 + 5, 5, &mut rng);
        assert_eq!(off, Step { state: 4 * 25, reward: -1.0, terminated: false });
    }

    #[test]
    fn a_car_stands_still_on_the_starting_line_only() {
        let (track, mut rng) = (corridor(), Pcg64::new(&SeedSequence::new(&[0])));
        assert_eq!(track.step(4 * 25, 4, &mut rng).state, 4 * 25);
        assert_eq!(track.step(3 * 25 + 5, 1, &mut rng).state, 2 * 25 + 5);
    }
}
