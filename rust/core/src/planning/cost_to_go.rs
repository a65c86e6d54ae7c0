//! The car's cost-to-go on a fine grid: value iteration whose next states lie between the grid's points.
//!
//! Interpolation smears the edges where one more swing is needed, so these steps are a guide, not the truth (Sutton &
//! Barto, 2nd ed., Figure 10.1 shows the surface).

use std::sync::atomic::{AtomicBool, Ordering};

use super::PlanningError;
use crate::envs::classic_control::{MountainCar, MountainCarState};
use crate::numeric::argmax;

/// Points along the positions and along the velocities; with half as many, the routes are a tenth of a step longer.
const POINTS: [usize; 2] = [1441, 561];
/// The coarsest grid has only every 16th point; each finer one begins with the steps of the one before.
const COARSEST: usize = 16;
/// A sweep that changes no point by more, in steps, is the last.
const CONVERGED: f64 = 1e-2;
/// No sweep looks further ahead than this, and none less far: short limits are no reason to see less.
const HORIZONS: (f64, f64) = (200.0, 1000.0);
const ACTIONS: usize = 3;

/// How many steps it takes to the goal.
#[derive(Clone, Debug, PartialEq)]
pub struct CostToGo {
    car: MountainCar,
    points: [usize; 2],
    /// For each position and each velocity: steps, at most the horizon.
    steps: Vec<f64>,
    horizon: f64,
}

/// A state between four points: the lowest of them, and how far it is from there to the next, along both axes. There
/// are millions of them.
#[derive(Clone, Copy)]
struct GridPoint {
    point: u32,
    shares: [f32; 2],
}

/// Beyond the goal.
const GOAL: GridPoint = GridPoint { point: u32::MAX, shares: [0.0; 2] };

impl CostToGo {
    /// Sweeps until the steps settle. `limit` is the time limit: where no way to the goal is seen within it (or within
    /// 200 steps where it is shorter, 1,000 where it is longer), the steps are that many.
    ///
    /// # Errors
    /// `Stopped` after `stop` was set.
    pub fn new(car: MountainCar, limit: u64, stop: &AtomicBool) -> Result<Self, PlanningError> {
        let horizon = (limit as f64).clamp(HORIZONS.0, HORIZONS.1);
        let mut coarser = Self { car, points: [2, 2], steps: vec![0.0; 4], horizon };
        let mut every = COARSEST;
        loop {
            let points = POINTS.map(|points| (points - 1) / every + 1);
            let mut finer = Self { car, points, steps: vec![0.0; points[0] * points[1]], horizon };
            finer.steps = (0..finer.steps.len()).map(|point| coarser.steps(finer.state(point))).collect();
            finer.converge(stop)?;
            if every == 1 {
                return Ok(finer);
            }
            (coarser, every) = (finer, every / 2);
        }
    }

    /// Value iteration, in place.
    fn converge(&mut self, stop: &AtomicBool) -> Result<(), PlanningError> {
        let next: Vec<[GridPoint; ACTIONS]> = (0..self.steps.len())
            .map(|point| {
                std::array::from_fn(|action| {
                    let after = self.car.transition(self.state(point), action);
                    if after.terminated { GOAL } else { self.place(after.state) }
                })
            })
            .collect();
        let last = next.len() - 1;
        loop {
            let mut change = 0.0_f64;
            // There and back: what is known spreads both ways.
            for point in (0..=last).chain((0..=last).rev()) {
                let steps = next[point].iter().map(|&place| 1.0 + self.between(place));
                let fewest = steps.fold(self.horizon, f64::min);
                change = change.max((fewest - self.steps[point]).abs());
                self.steps[point] = fewest;
            }
            if change < CONVERGED {
                return Ok(());
            }
            if stop.load(Ordering::Acquire) {
                return Err(PlanningError::Stopped);
            }
        }
    }

    /// The car that this is about.
    pub fn car(&self) -> &MountainCar {
        &self.car
    }

    /// Whether it sees a way from a state to the goal.
    pub fn reachable(&self, state: MountainCarState) -> bool {
        self.steps(state) < self.horizon
    }

    /// The steps of a state that is on the way.
    pub fn steps(&self, state: MountainCarState) -> f64 {
        self.between(self.place(state))
    }

    /// For each action the steps, this one counted.
    pub fn action_steps(&self, state: MountainCarState) -> [f64; ACTIONS] {
        std::array::from_fn(|action| {
            let step = self.car.transition(state, action);
            1.0 + if step.terminated { 0.0 } else { self.steps(step.state) }
        })
    }

    /// The first of the actions that take the fewest.
    pub fn best_action(&self, state: MountainCarState) -> usize {
        argmax(&self.action_steps(state).map(|steps| -steps))
    }

    /// The positions and the velocities of the grid.
    pub fn axes(&self) -> [Vec<f64>; 2] {
        let points = |axis: usize| (0..self.points[axis]).map(|index| self.coordinate(axis, index)).collect();
        [points(0), points(1)]
    }

    /// The steps of all points, the velocities of the first position first.
    pub fn grid(&self) -> &[f64] {
        &self.steps
    }

    /// For each point the steps of each action.
    pub fn action_grid(&self) -> Vec<f64> {
        (0..self.steps.len()).flat_map(|point| self.action_steps(self.state(point))).collect()
    }

    fn bounds(&self, axis: usize) -> (f64, f64) {
        let car = &self.car;
        if axis == 0 { (car.min_position, car.max_position) } else { (-car.max_speed, car.max_speed) }
    }

    fn coordinate(&self, axis: usize, index: usize) -> f64 {
        let ((low, high), last) = (self.bounds(axis), self.points[axis] - 1);
        if index == last { high } else { low + (high - low) * (index as f64 / last as f64) }
    }

    fn state(&self, point: usize) -> MountainCarState {
        MountainCarState {
            position: self.coordinate(0, point / self.points[1]),
            velocity: self.coordinate(1, point % self.points[1]),
        }
    }

    fn place(&self, state: MountainCarState) -> GridPoint {
        let along = |axis: usize, value: f64| {
            let (low, high) = self.bounds(axis);
            let last = (self.points[axis] - 1) as f64;
            let index = ((value - low) / (high - low) * last).clamp(0.0, last);
            let lowest = index.floor().min(last - 1.0);
            (lowest as usize, index - lowest)
        };
        let ((position, position_share), (velocity, velocity_share)) =
            (along(0, state.position), along(1, state.velocity));
        let shares = [position_share as f32, velocity_share as f32];
        GridPoint { point: (position * self.points[1] + velocity) as u32, shares }
    }

    fn between(&self, GridPoint { point, shares }: GridPoint) -> f64 {
        if point == GOAL.point {
            return 0.0;
        }
        let (point, [position, velocity]) = (point as usize, shares.map(f64::from));
        let row = |from: usize| self.steps[from] + (self.steps[from + 1] - self.steps[from]) * velocity;
        let (here, next) = (row(point), row(point + self.points[1]));
        here + (next - here) * position
    }
}
