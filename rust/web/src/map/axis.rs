//! An axis of a plane through the observations.

use std::f64::consts::PI;

use crate::environment::{Bounds, Environment};
use crate::settings::Discretizer;

/// The largest number of cells along an axis; finer grids are shown at this many points.
const MAX_CELLS: usize = 128;

/// A component of the observations, or an angle that they give by its cosine and its sine.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axis {
    /// The component, or that of the cosine, which the sine follows.
    component: usize,
    is_angle: bool,
}

impl Axis {
    /// The axis of a component: an angle if the component is the cosine of one.
    pub(super) fn new(environment: &Environment, component: usize) -> Self {
        Self { component, is_angle: environment.cosines().contains(&component) }
    }

    /// The place of an observation along the axis.
    pub(super) fn place(self, observation: &[f64]) -> f64 {
        let number = |component: usize| observation.get(component).copied().unwrap_or(0.0);
        let number_here = number(self.component);
        if self.is_angle { number(self.component + 1).atan2(number_here) } else { number_here }
    }

    /// Moves an observation to a place along the axis.
    pub(super) fn put(self, observation: &mut [f64], place: f64) {
        if self.is_angle {
            observation[self.component..=self.component + 1].copy_from_slice(&[place.cos(), place.sin()]);
        } else {
            observation[self.component] = place;
        }
    }

    /// The edges of the cells along the axis, ascending: those of the discretizer, or of `count` cells of equal width.
    pub(super) fn edges(self, discretizer: &Discretizer, bounds: Bounds, count: u32) -> Vec<f64> {
        let even = |low: f64, high: f64, count: u32| {
            (0..=count).map(|edge| low + (high - low) * f64::from(edge) / f64::from(count)).collect()
        };
        if self.is_angle {
            return even(-PI, PI, count);
        }
        if let Discretizer::Grid(grid) = discretizer {
            let edges = &grid.edges[self.component];
            if edges.len() > MAX_CELLS + 1 {
                return even(edges[0], edges[edges.len() - 1], MAX_CELLS as u32);
            }
            return edges.clone();
        }
        let (low, high) = bounds[self.component];
        let (low, high) = discretizer.limits().map_or((low.into(), high.into()), |limits| limits[self.component]);
        even(low, high, count)
    }
}
