//! The cost-to-go of `MountainCar`, the number of steps to the goal, by value iteration with interpolation on a fine grid
//! (Sutton & Barto, Figure 10.1 shows the surface).
//!
//! Interpolation blurs the edges where one more swing is needed, so the result is a heuristic, not exact.

use crate::StopFlag;

use super::PlanningError;
use crate::envs::classic_control::{MountainCar, MountainCarState};
use crate::numeric::argmax;

/// The number of grid points along positions and velocities. With half as many, the routes of the beam search are a tenth
/// of a step longer.
const POINTS: [usize; 2] = [1441, 561];
/// The coarsest grid has every 16th point only. Each finer grid starts from the result of the previous one.
const COARSEST_STRIDE: usize = 16;
/// The iteration ends when a sweep changes no point by this number of steps.
const CONVERGED: f64 = 1e-2;
/// The bounds of the horizon. A time limit below them would only hide routes to the goal, one above them costs time.
const HORIZON_BOUNDS: (f64, f64) = (200.0, 1000.0);
const NUM_ACTIONS: usize = 3;

/// The number of steps to the goal from every state, interpolated between grid points.
#[derive(Clone, Debug, PartialEq)]
pub struct CostToGo {
    car: MountainCar,
    points: [usize; 2],
    /// The steps from each grid point, at most the horizon, in C order (position, velocity).
    steps: Vec<f64>,
    horizon: f64,
}

/// A state between four grid points: the index of the lowest one, and the fractions of the way to the next along both
/// axes. It is compact because there are millions of them.
#[derive(Clone, Copy)]
struct GridPosition {
    point: u32,
    fractions: [f32; 2],
}

/// The goal, with no steps to go.
const GOAL: GridPosition = GridPosition { point: u32::MAX, fractions: [0.0; 2] };

impl CostToGo {
    /// Iterates until convergence. The horizon is the time limit, clamped to [200, 1000] steps. States from which the
    /// goal is not reached within the horizon have that number of steps.
    ///
    /// # Errors
    /// `Stopped` after `stop` was set.
    pub fn new(car: MountainCar, max_steps: u64, stop: &StopFlag<'_>) -> Result<Self, PlanningError> {
        Self::coarse(car, max_steps, 1, stop)
    }

    /// The same on a coarser grid, of every `finest_stride`-th point along both axes, where it is 1, 2, 4, 8 or 16: the
    /// iteration then takes a fraction of the time, and values near the edges are off by more.
    ///
    /// # Errors
    /// `Stopped` after `stop` was set.
    ///
    /// # Panics
    /// For another stride.
    pub fn coarse(
        car: MountainCar,
        max_steps: u64,
        finest_stride: usize,
        stop: &StopFlag<'_>,
    ) -> Result<Self, PlanningError> {
        assert!([1, 2, 4, 8, 16].contains(&finest_stride), "stride must be 1, 2, 4, 8 or 16, got {finest_stride}");
        let horizon = (max_steps as f64).clamp(HORIZON_BOUNDS.0, HORIZON_BOUNDS.1);
        let mut coarser = Self { car, points: [2, 2], steps: vec![0.0; 4], horizon };
        let mut stride = COARSEST_STRIDE;
        loop {
            let points = POINTS.map(|points| (points - 1) / stride + 1);
            let mut finer = Self { car, points, steps: vec![0.0; points[0] * points[1]], horizon };
            finer.steps = (0..finer.steps.len()).map(|point| coarser.steps(finer.state(point))).collect();
            finer.converge(stop)?;
            if stride == finest_stride {
                return Ok(finer);
            }
            (coarser, stride) = (finer, stride / 2);
        }
    }

    /// Value iteration in place: steps(s) ← minₐ 1 + steps(s′).
    fn converge(&mut self, stop: &StopFlag<'_>) -> Result<(), PlanningError> {
        let next_positions: Vec<[GridPosition; NUM_ACTIONS]> = (0..self.steps.len())
            .map(|point| {
                std::array::from_fn(|action| {
                    let next = self.car.transition(self.state(point), action);
                    if next.terminated { GOAL } else { self.grid_position(next.state) }
                })
            })
            .collect();
        let last = next_positions.len() - 1;
        loop {
            let mut change = 0.0_f64;
            // Forwards and backwards, so that changes spread in both directions.
            for point in (0..=last).chain((0..=last).rev()) {
                let steps = next_positions[point].iter().map(|&position| 1.0 + self.interpolate(position));
                let fewest = steps.fold(self.horizon, f64::min);
                change = change.max((fewest - self.steps[point]).abs());
                self.steps[point] = fewest;
            }
            if change < CONVERGED {
                return Ok(());
            }
            if stop.is_set() {
                return Err(PlanningError::Stopped);
            }
        }
    }

    /// The environment.
    pub fn car(&self) -> &MountainCar {
        &self.car
    }

    /// Whether the goal can be reached from a state within the horizon.
    pub fn is_reachable(&self, state: MountainCarState) -> bool {
        self.steps(state) < self.horizon
    }

    /// The steps from a non-terminal state.
    pub fn steps(&self, state: MountainCarState) -> f64 {
        self.interpolate(self.grid_position(state))
    }

    /// The steps after each action, including its own step.
    pub fn action_steps(&self, state: MountainCarState) -> [f64; NUM_ACTIONS] {
        std::array::from_fn(|action| {
            let step = self.car.transition(state, action);
            1.0 + if step.terminated { 0.0 } else { self.steps(step.state) }
        })
    }

    /// The action with the fewest steps, the first one of several.
    pub fn best_action(&self, state: MountainCarState) -> usize {
        argmax(&self.action_steps(state).map(|steps| -steps))
    }

    /// The positions and velocities of the grid.
    pub fn axes(&self) -> [Vec<f64>; 2] {
        let points = |axis: usize| (0..self.points[axis]).map(|index| self.coordinate(axis, index)).collect();
        [points(0), points(1)]
    }

    /// The steps from all grid points, in C order (position, velocity).
    pub fn grid(&self) -> &[f64] {
        &self.steps
    }

    /// The steps after each action from all grid points, in C order (position, velocity, action).
    pub fn action_grid(&self) -> Vec<f64> {
        (0..self.steps.len()).flat_map(|point| self.action_steps(self.state(point))).collect()
    }

    /// The range of an axis: 0 is the position, 1 the velocity.
    fn bounds(&self, axis: usize) -> (f64, f64) {
        let car = &self.car;
        if axis == 0 { (car.min_position, car.max_position) } else { (-car.max_speed, car.max_speed) }
    }

    /// A coordinate of the grid.
    fn coordinate(&self, axis: usize, index: usize) -> f64 {
        let ((low, high), last) = (self.bounds(axis), self.points[axis] - 1);
        if index == last { high } else { low + (high - low) * (index as f64 / last as f64) }
    }

    /// The state at a grid point.
    fn state(&self, point: usize) -> MountainCarState {
        MountainCarState {
            position: self.coordinate(0, point / self.points[1]),
            velocity: self.coordinate(1, point % self.points[1]),
        }
    }

    /// Where a state lies between the grid points.
    fn grid_position(&self, state: MountainCarState) -> GridPosition {
        let along = |axis: usize, value: f64| {
            let (low, high) = self.bounds(axis);
            let last = (self.points[axis] - 1) as f64;
            let index = ((value - low) / (high - low) * last).clamp(0.0, last);
            let lowest = index.floor().min(last - 1.0);
            (lowest as usize, index - lowest)
        };
        let ((position, position_fraction), (velocity, velocity_fraction)) =
            (along(0, state.position), along(1, state.velocity));
        let fractions = [position_fraction as f32, velocity_fraction as f32];
        GridPosition { point: (position * self.points[1] + velocity) as u32, fractions }
    }

    /// Bilinear interpolation of the steps.
    fn interpolate(&self, GridPosition { point, fractions }: GridPosition) -> f64 {
        if point == GOAL.point {
            return 0.0;
        }
        let (point, [position, velocity]) = (point as usize, fractions.map(f64::from));
        let along_velocity = |from: usize| self.steps[from] + (self.steps[from + 1] - self.steps[from]) * velocity;
        let (lower, upper) = (along_velocity(point), along_velocity(point + self.points[1]));
        lower + (upper - lower) * position
    }
}
