//! The table of `CliffWalking-v1` (Sutton & Barto, Example 6.6).

use crate::envs::tabular::{InvalidMdp, Outcome, TabularMdp};

const ROWS: i64 = 4;
const COLUMNS: i64 = 12;
const FIRST_STATE: i64 = (ROWS - 1) * COLUMNS;
const GOAL: i64 = ROWS * COLUMNS - 1;
/// The rows and the columns that an action moves by: up, right, down, left.
const MOVES: [(i64, i64); 4] = [(-1, 0), (0, 1), (1, 0), (0, -1)];

/// The table as Gymnasium's constructor builds it. On slippery ground the chosen direction and the two perpendicular to
/// it are equally likely.
///
/// # Errors
/// None in practice; the type is that of [`TabularMdp::new`].
pub fn cliff_walking(is_slippery: bool) -> Result<TabularMdp, InvalidMdp> {
    let initial: Vec<f64> = (0..ROWS * COLUMNS).map(|state| f64::from(u8::from(state == FIRST_STATE))).collect();
    let turns: &[usize] = if is_slippery { &[3, 0, 1] } else { &[0] };
    let pairs: Vec<Vec<Outcome>> = (0..ROWS * COLUMNS)
        .flat_map(|state| (0..MOVES.len()).map(move |action| (state, action)))
        .map(|(state, action)| turns.iter().map(|turn| outcome(state, (action + turn) % 4, turns.len())).collect())
        .collect();
    TabularMdp::new(MOVES.len(), &initial, &pairs)
}

/// One of `count` equally likely outcomes: a move in a direction.
fn outcome(state: i64, direction: usize, count: usize) -> Outcome {
    let (down, right) = MOVES[direction];
    let row = (state / COLUMNS + down).clamp(0, ROWS - 1);
    let column = (state % COLUMNS + right).clamp(0, COLUMNS - 1);
    let next = row * COLUMNS + column;
    let falls = (FIRST_STATE + 1..GOAL).contains(&next);
    Outcome {
        probability: 1.0 / count as f64,
        state: if falls { FIRST_STATE } else { next },
        reward: if falls { -100.0 } else { -1.0 },
        terminated: next == GOAL,
    }
}
