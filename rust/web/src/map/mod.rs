//! The cells of a value map: those of a table's map, or of a plane through the observations.

mod axis;
pub(crate) mod best;

use serde_json::Value;

use self::axis::Axis;
use crate::environment::{Board, Environment};
use crate::json::{integer, numbers};
use crate::settings::Discretizer;

/// The number of cells along an axis if the discretizer has no cells.
const DEFAULT_CELLS: u32 = 48;

/// The cells of a map, counted row by row from the upper left corner.
#[derive(Clone, Debug)]
pub(crate) enum Cells {
    /// Numbered states.
    States(Board),
    /// Cells of a plane through the observations.
    Plane(Plane),
}

/// Two axes through the observations; the other components are fixed.
#[derive(Clone, Debug)]
pub(crate) struct Plane {
    axes: [Axis; 2],
    at: Vec<f64>,
    /// The edges of the columns, ascending.
    pub(crate) x_edges: Vec<f64>,
    /// The edges of the rows, descending, since the top row comes first.
    pub(crate) y_edges: Vec<f64>,
}

impl Cells {
    /// The cells that a request specifies in `map`, or the default ones, for runs whose first observation is this one.
    pub(crate) fn new(
        environment: &Environment,
        discretizer: &Discretizer,
        map: Option<&Value>,
        first: &[f64],
    ) -> Result<Self, String> {
        if let Some(board) = environment.board(first.first().map_or(0, |&state| state as usize)) {
            return Ok(Self::States(board));
        }
        let bounds = environment.bounds().unwrap_or_default();
        let get = |name: &str| map.and_then(|map| map.get(name));
        let bounded = |name: &str, default: u32, most: u32| match get(name) {
            None => Ok(default),
            Some(given) => {
                integer(given, most).ok_or_else(|| format!("map.{name} must be an integer from 0 to {most}"))
            }
        };
        let last = bounds.len() as u32 - 1;
        let axes = [bounded("x", 0, last)?, bounded("y", 1.min(last), last)?]
            .map(|component| Axis::new(environment, component as usize));
        let counts = [bounded("columns", DEFAULT_CELLS, 128)?.max(1), bounded("rows", DEFAULT_CELLS, 128)?.max(1)];
        let at = match get("at") {
            None => vec![0.0; bounds.len()],
            Some(at) => numbers(at)
                .filter(|at| at.len() == bounds.len())
                .ok_or("map.at must hold a number for each component")?,
        };
        let [x_edges, mut y_edges] = [0, 1].map(|axis| axes[axis].edges(discretizer, bounds, counts[axis]));
        y_edges.reverse();
        Ok(Self::Plane(Plane { axes, at, x_edges, y_edges }))
    }

    pub(crate) fn columns(&self) -> usize {
        match self {
            Self::States(board) => board.columns,
            Self::Plane(plane) => plane.x_edges.len() - 1,
        }
    }

    pub(crate) fn rows(&self) -> usize {
        match self {
            Self::States(board) => board.states.len() / board.columns,
            Self::Plane(plane) => plane.y_edges.len() - 1,
        }
    }

    pub(crate) fn count(&self) -> usize {
        self.columns() * self.rows()
    }

    /// The observation in the middle of a cell; `None` for walls and invalid cells.
    pub(crate) fn observation(&self, cell: usize) -> Option<Vec<f64>> {
        match self {
            Self::States(board) => board.states.get(cell).copied().flatten().map(|state| vec![state.into()]),
            Self::Plane(plane) => {
                if cell >= self.count() {
                    return None;
                }
                let middle = |edges: &[f64], index: usize| edges[index].midpoint(edges[index + 1]);
                let mut observation = plane.at.clone();
                let [x, y] = plane.axes;
                x.put(&mut observation, middle(&plane.x_edges, cell % self.columns()));
                y.put(&mut observation, middle(&plane.y_edges, cell / self.columns()));
                Some(observation)
            }
        }
    }

    /// The cell of an observation; observations outside the plane belong to the outermost cells.
    pub(crate) fn cell(&self, observation: &[f64]) -> usize {
        match self {
            Self::States(board) => {
                observation.first().and_then(|&state| board.cells.get(state as usize)).copied().unwrap_or(0)
            }
            Self::Plane(plane) => {
                let [x, y] = plane.axes.map(|axis| axis.place(observation));
                let column = plane.x_edges[1..self.columns()].partition_point(|&edge| edge <= x);
                let row = plane.y_edges[1..self.rows()].partition_point(|&edge| edge > y);
                row * self.columns() + column
            }
        }
    }
}
