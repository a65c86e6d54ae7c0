//! `Taxi`: its transition table and its map.

use qtab_core::envs::tabular::TabularMdp;
use qtab_core::envs::toy_text::{TaxiMap, taxi_table};

use super::Board;

/// Gymnasium's map.
const MAP: &TaxiMap = &[
    *b"+---------+",
    *b"|R: | : :G|",
    *b"| : | : : |",
    *b"| : : : : |",
    *b"| | : | : |",
    *b"|Y| : |B: |",
    *b"+---------+",
];
const SIZE: usize = 5;
const DESTINATIONS: usize = 4;
/// The locations of the passenger; the last one is in the taxi.
const LOCATIONS: usize = 5;
const IN_TAXI: usize = LOCATIONS - 1;
/// The columns of the map of values: the squares before the passenger is in the taxi, a gap, and the squares after it.
const COLUMNS: usize = 2 * SIZE + 1;

pub(crate) fn table() -> Result<TabularMdp, String> {
    taxi_table(MAP, None).map_err(|error| error.to_string())
}

/// The squares for the passenger and the destination of a state: on the left while the passenger waits, on the right
/// in the taxi.
pub(crate) fn board(state: usize) -> Board {
    let (destination, location) = (state % DESTINATIONS, state / DESTINATIONS % LOCATIONS);
    let index = |square: usize, location: usize| (square * LOCATIONS + location) * DESTINATIONS + destination;
    let cell = |cell: usize| {
        let (row, column) = (cell / COLUMNS, cell % COLUMNS);
        match column {
            SIZE => None,
            0..SIZE => Some(index(row * SIZE + column, location) as u32),
            _ => Some(index(row * SIZE + column - SIZE - 1, IN_TAXI) as u32),
        }
    };
    let cell_of = |state: usize| {
        let square = state / (LOCATIONS * DESTINATIONS);
        let in_taxi = state / DESTINATIONS % LOCATIONS == IN_TAXI;
        square / SIZE * COLUMNS + square % SIZE + if in_taxi { SIZE + 1 } else { 0 }
    };
    let states = SIZE * SIZE * LOCATIONS * DESTINATIONS;
    Board {
        columns: COLUMNS,
        states: (0..SIZE * COLUMNS).map(cell).collect(),
        cells: (0..states).map(cell_of).collect(),
    }
}
