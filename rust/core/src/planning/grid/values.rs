//! State values by value iteration on a grid, with multilinear interpolation between its points (R. Munos and A. Moore,
//! 2002).
//!
//! Interpolation blurs the edges of values, so the result is a heuristic, not exact.

use super::super::{MAX_SWEEPS, PlanningError};
use super::GridTask;
use crate::StopFlag;
use crate::memory::{collect, reserve};

/// The number of grid points around a state of four numbers.
const MAX_CORNERS: usize = 16;

/// The value of every state of a task, interpolated between the points of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct GridValues<T, const D: usize> {
    task: T,
    points: [usize; D],
    corners: [usize; MAX_CORNERS],
    /// The values at the grid points, in C order.
    values: Vec<f64>,
    /// The values of all actions at the grid points, in C order, actions last.
    action_values: Vec<f64>,
    lowest: f64,
}

/// A reward and the next state: the index of the lowest grid point around it, and the fractions of the way to the next
/// point along each axis. It is compact because there are millions of successors.
#[derive(Clone, Copy)]
struct Successor<const D: usize> {
    reward: f64,
    point: u32,
    fractions: [f32; D],
}

/// The number of grid points between two checks of the stop flag: about a millisecond of work.
const POINTS_BETWEEN_CHECKS: usize = 1024;

/// The point of a terminal state, whose value is 0.
const TERMINAL: u32 = u32::MAX;

impl<T: GridTask<D>, const D: usize> GridValues<T, D> {
    /// Iterates until convergence, from coarse grids to the finest one: every `finest_stride`-th point along each axis.
    /// A stride of 1 is the task's full grid; a larger one takes a fraction of the time, but is less accurate at the
    /// edges.
    ///
    /// # Errors
    /// `Stopped` after `stop` was set; `OutOfMemory`; `NotConverged` if the values of a grid do not settle.
    ///
    /// # Panics
    /// If the stride is not a power of two up to the task's coarsest one.
    pub fn new(task: T, max_steps: u64, finest_stride: usize, stop: &StopFlag<'_>) -> Result<Self, PlanningError> {
        let coarsest = T::COARSEST_STRIDE;
        let fits = finest_stride.is_power_of_two() && finest_stride <= coarsest;
        assert!(fits, "stride must be a power of two up to {coarsest}, got {finest_stride}");
        let lowest = task.lowest_value(max_steps);
        let on = |points| Self {
            task,
            points,
            corners: corners(points),
            values: Vec::new(),
            action_values: Vec::new(),
            lowest,
        };
        let mut coarser = Self { values: vec![0.0; 1 << D], ..on([2; D]) };
        let mut stride = coarsest;
        loop {
            let points = T::POINTS.map(|points| (points - 1) / stride + 1);
            let mut finer = on(points);
            finer.values = collect((0..points.iter().product()).map(|point| coarser.value(finer.state(point))))?;
            let successors = finer.successors(stop)?;
            finer.converge(&successors, stop)?;
            if stride == finest_stride {
                finer.action_values = collect(successors.iter().map(|outcome| finer.outcome_value(outcome)))?;
                return Ok(finer);
            }
            (coarser, stride) = (finer, stride / 2);
        }
    }

    /// The successor of each action at each grid point, in C order, actions last.
    fn successors(&self, stop: &StopFlag<'_>) -> Result<Vec<Successor<D>>, PlanningError> {
        let mut successors = Vec::new();
        reserve(&mut successors, self.values.len() * T::ACTIONS)?;
        for point in 0..self.values.len() {
            if point % POINTS_BETWEEN_CHECKS == 0 && stop.is_set() {
                return Err(PlanningError::Stopped);
            }
            let state = self.state(point);
            successors.extend((0..T::ACTIONS).map(|action| {
                let taken = self.task.transition(state, action);
                let (point, fractions) =
                    if taken.terminated { (TERMINAL, [0.0; D]) } else { self.position(taken.state) };
                Successor { reward: taken.reward, point, fractions }
            }));
        }
        Ok(successors)
    }

    /// Value iteration in place: v(s) ← maxₐ r + γ v(s′).
    fn converge(&mut self, successors: &[Successor<D>], stop: &StopFlag<'_>) -> Result<(), PlanningError> {
        let last = self.values.len() - 1;
        for _ in 0..MAX_SWEEPS {
            let mut change = 0.0_f64;
            // Forwards and backwards, so that changes spread in both directions.
            for point in (0..=last).chain((0..=last).rev()) {
                let possible = successors[point * T::ACTIONS..][..T::ACTIONS].iter();
                // A sweep reads rewards in float32, like the fractions. The best known values were found with float32
                // rewards.
                let outcomes =
                    possible.map(|&outcome| Successor { reward: f64::from(outcome.reward as f32), ..outcome });
                let best = outcomes.map(|outcome| self.outcome_value(&outcome)).fold(self.lowest, f64::max);
                change = change.max((best - self.values[point]).abs());
                self.values[point] = best;
            }
            if change < T::CONVERGED {
                return Ok(());
            }
            if stop.is_set() {
                return Err(PlanningError::Stopped);
            }
        }
        Err(PlanningError::NotConverged { sweeps: MAX_SWEEPS })
    }

    /// The environment.
    pub fn task(&self) -> &T {
        &self.task
    }

    /// The value of a non-terminal state.
    pub fn value(&self, state: [f64; D]) -> f64 {
        let (point, fractions) = self.position(state);
        self.interpolate(point, fractions)
    }

    /// Whether the value of a state is above the lowest value.
    pub fn is_above_lowest(&self, state: [f64; D]) -> bool {
        self.value(state) > self.lowest
    }

    /// The value of an action in a state.
    pub fn action_value(&self, state: [f64; D], action: usize) -> f64 {
        let step = self.task.transition(state, action);
        step.reward + if step.terminated { 0.0 } else { T::DISCOUNT * self.value(step.state) }
    }

    /// The action with the highest value, the first one if several are equal.
    pub fn best_action(&self, state: [f64; D]) -> usize {
        let mut best = (0, f64::NEG_INFINITY);
        for action in 0..T::ACTIONS {
            let value = self.action_value(state, action);
            if value > best.1 {
                best = (action, value);
            }
        }
        best.0
    }

    /// The coordinates of the grid points along each axis.
    pub fn axes(&self) -> [Vec<f64>; D] {
        std::array::from_fn(|axis| (0..self.points[axis]).map(|index| self.coordinate(axis, index)).collect())
    }

    /// The values at all grid points, in C order.
    pub fn grid(&self) -> &[f64] {
        &self.values
    }

    /// The values of all actions at all grid points, in C order, actions last.
    pub fn action_grid(&self) -> &[f64] {
        &self.action_values
    }

    /// The value of a state-action pair: its reward, and the value of the next state.
    #[inline]
    fn outcome_value(&self, outcome: &Successor<D>) -> f64 {
        outcome.reward + T::DISCOUNT * self.interpolate(outcome.point, outcome.fractions)
    }

    fn coordinate(&self, axis: usize, index: usize) -> f64 {
        let ((low, high), last) = (self.task.bounds()[axis], self.points[axis] - 1);
        if index == last { high } else { low + (high - low) * (index as f64 / last as f64) }
    }

    /// The state at a grid point.
    fn state(&self, mut point: usize) -> [f64; D] {
        let mut state = [0.0; D];
        for axis in (0..D).rev() {
            state[axis] = self.coordinate(axis, point % self.points[axis]);
            point /= self.points[axis];
        }
        state
    }

    /// The position of a state between the grid points.
    fn position(&self, state: [f64; D]) -> (u32, [f32; D]) {
        let (bounds, mut point, mut fractions) = (self.task.bounds(), 0, [0.0; D]);
        for axis in 0..D {
            let ((low, high), last) = (bounds[axis], (self.points[axis] - 1) as f64);
            let index = ((state[axis] - low) / (high - low) * last).clamp(0.0, last);
            let lowest = index.floor().min(last - 1.0);
            point = point * self.points[axis] + lowest as usize;
            fractions[axis] = (index - lowest) as f32;
        }
        (point as u32, fractions)
    }

    /// Multilinear interpolation, along the last axis first.
    fn interpolate(&self, point: u32, fractions: [f32; D]) -> f64 {
        if point == TERMINAL {
            return 0.0;
        }
        let point = point as usize;
        let mut values = [0.0; MAX_CORNERS];
        for (value, corner) in values[..1 << D].iter_mut().zip(&self.corners) {
            *value = self.values[point + corner];
        }
        for axis in (0..D).rev() {
            let fraction = f64::from(fractions[axis]);
            for pair in 0..1 << axis {
                let (lower, upper) = (values[2 * pair], values[2 * pair + 1]);
                values[pair] = lower + (upper - lower) * fraction;
            }
        }
        values[0]
    }
}

/// The offset of each point around a state from the lowest one. The last axis is the lowest bit of a corner's number.
fn corners<const D: usize>(points: [usize; D]) -> [usize; MAX_CORNERS] {
    std::array::from_fn(|corner| {
        let mut stride = 1;
        (0..D).rev().fold(0, |distance, axis| {
            let step = (corner >> (D - 1 - axis) & 1) * stride;
            stride *= points[axis];
            distance + step
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envs::Step;

    /// A task in which each step is worth 1 and leads back: as no episode ends, the values grow forever.
    #[derive(Clone, Copy, Debug, PartialEq)]
    struct NeverEnding;

    impl GridTask<1> for NeverEnding {
        const POINTS: [usize; 1] = [2];
        const COARSEST_STRIDE: usize = 1;
        const CONVERGED: f64 = 1e-2;
        const ACTIONS: usize = 1;

        fn bounds(&self) -> [(f64, f64); 1] {
            [(0.0, 1.0)]
        }

        fn transition(&self, state: [f64; 1], _action: usize) -> Step<[f64; 1]> {
            Step { state, reward: 1.0, terminated: false }
        }

        fn lowest_value(&self, _max_steps: u64) -> f64 {
            0.0
        }
    }

    #[test]
    fn values_that_never_settle_are_an_error() {
        let values = GridValues::new(NeverEnding, 10, 1, &StopFlag::new());
        assert_eq!(values, Err(PlanningError::NotConverged { sweeps: MAX_SWEEPS }));
    }
}
