//! The table of `Taxi-v4` (T. Dietterich, 2000), in dry weather and in rain.

use crate::envs::tabular::{InvalidMdp, Outcome, TabularMdp};

/// The number of rows and of columns.
const SIZE: i64 = 5;
/// The stands, the possible locations of the passenger and the destination: row and column.
const STANDS: [(i64, i64); 4] = [(0, 0), (0, 4), (4, 0), (4, 3)];
/// The passenger's location once they are in the taxi.
const IN_TAXI: usize = STANDS.len();
/// Gymnasium's `MAP`: a border around the squares, and between two squares of a row `:` for a passage or `|` for a
/// wall.
pub type TaxiMap = [[u8; 2 * SIZE as usize + 1]; SIZE as usize + 2];
/// The rows and the columns that an action moves by: south, north, east, west.
const MOVES: [(i64, i64); 4] = [(1, 0), (-1, 0), (0, 1), (0, -1)];
/// The indices of the directions to the left and right of each move.
const SIDES: [[usize; 2]; 4] = [[2, 3], [3, 2], [1, 0], [0, 1]];
const PICK_UP: usize = 4;
const NUM_ACTIONS: usize = 6;

/// A state, decoded.
#[derive(Clone, Copy)]
struct Ride {
    square: (i64, i64),
    passenger: usize,
    destination: usize,
}

impl Ride {
    fn encode(self) -> i64 {
        let (row, column) = self.square;
        let locations = (row * SIZE + column) as usize * (IN_TAXI + 1) + self.passenger;
        ((locations * STANDS.len() + self.destination) as u64).cast_signed()
    }
}

/// The table as Gymnasium's constructor builds it from a map. In rain, a move succeeds with `rainy_probability` and
/// otherwise drifts to one of its sides; `None` means dry weather.
///
/// # Errors
/// If the probability does not lie in [0, 1]; and those of [`TabularMdp::new`].
pub fn taxi_table(map: &TaxiMap, rainy_probability: Option<f64>) -> Result<TabularMdp, InvalidMdp> {
    let (mut initial, mut pairs) = (Vec::new(), Vec::new());
    for row in 0..SIZE {
        for column in 0..SIZE {
            for passenger in 0..=IN_TAXI {
                for destination in 0..STANDS.len() {
                    let ride = Ride { square: (row, column), passenger, destination };
                    initial.push(f64::from(u8::from(passenger != IN_TAXI && passenger != destination)));
                    pairs.extend((0..NUM_ACTIONS).map(|action| match MOVES.get(action) {
                        Some(_) => travel(map, ride, action, rainy_probability),
                        None if action == PICK_UP => vec![pick_up(ride)],
                        None => vec![drop_off(ride)],
                    }));
                }
            }
        }
    }
    let rides: f64 = initial.iter().sum();
    for count in &mut initial {
        *count /= rides;
    }
    TabularMdp::new(NUM_ACTIONS, &initial, &pairs)
}

fn outcome(probability: f64, ride: Ride, reward: f64, terminated: bool) -> Outcome {
    Outcome { probability, state: ride.encode(), reward, terminated }
}

fn travel(map: &TaxiMap, ride: Ride, direction: usize, rainy_probability: Option<f64>) -> Vec<Outcome> {
    let to = |probability, square| outcome(probability, Ride { square, ..ride }, -1.0, false);
    let free = is_free(map, ride.square, direction);
    let ahead = if free { moved(ride.square, direction) } else { ride.square };
    let Some(probability) = rainy_probability else { return vec![to(1.0, ahead)] };
    // A taxi that cannot go ahead does not drift either.
    let aside = SIDES[direction].map(|side| if free { drifted(map, ride.square, side) } else { ride.square });
    let lateral = (1.0 - probability) / 2.0;
    vec![to(probability, ahead), to(lateral, aside[0]), to(lateral, aside[1])]
}

/// Whether neither a wall nor the edge of the map is ahead.
fn is_free(map: &TaxiMap, (row, column): (i64, i64), direction: usize) -> bool {
    match MOVES[direction] {
        (0, right) => has_passage(map, row, if right > 0 { column } else { column - 1 }),
        (down, _) => (0..SIZE).contains(&(row + down)),
    }
}

/// Whether there is a passage between a square and the one to its right. Column -1 is the one left of the first square.
fn has_passage(map: &TaxiMap, row: i64, column: i64) -> bool {
    map[row as usize + 1][(2 * column + 2) as usize] == b':'
}

/// The next square in a direction; at the edge of the map the same square.
fn moved((row, column): (i64, i64), direction: usize) -> (i64, i64) {
    let (down, right) = MOVES[direction];
    ((row + down).clamp(0, SIZE - 1), (column + right).clamp(0, SIZE - 1))
}

/// The square that the taxi drifts to. Gymnasium looks for a wall next to the square that the taxi would reach: on the
/// left of that square if the taxi drifts east, on the right if it drifts west.
fn drifted(map: &TaxiMap, square: (i64, i64), direction: usize) -> (i64, i64) {
    let (row, column) = moved(square, direction);
    let blocked = match MOVES[direction] {
        (0, 1) => !has_passage(map, row, column - 1),
        (0, _) => !has_passage(map, row, column),
        _ => false,
    };
    if blocked { square } else { (row, column) }
}

fn pick_up(ride: Ride) -> Outcome {
    if STANDS.get(ride.passenger) == Some(&ride.square) {
        outcome(1.0, Ride { passenger: IN_TAXI, ..ride }, -1.0, false)
    } else {
        outcome(1.0, ride, -10.0, false)
    }
}

fn drop_off(ride: Ride) -> Outcome {
    match STANDS.iter().position(|&stand| stand == ride.square) {
        Some(stand) if ride.passenger == IN_TAXI => {
            let arrives = stand == ride.destination;
            outcome(1.0, Ride { passenger: stand, ..ride }, if arrives { 20.0 } else { -1.0 }, arrives)
        }
        _ => outcome(1.0, ride, -10.0, false),
    }
}
