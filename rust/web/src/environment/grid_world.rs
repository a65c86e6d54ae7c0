//! Painted grid worlds: the transition table of a map. `qtab.book.grid_world` makes the same table in Python.

use qtab_core::envs::tabular::{Outcome, TabularMdp};
use serde_json::Value;

use crate::json::{integer, shown};

/// The longest side of a grid, in cells.
const MAX_SIDE: usize = 40;
/// The changes of row and column for up, right, down, left.
const MOVES: [(isize, isize); 4] = [(-1, 0), (0, 1), (1, 0), (0, -1)];

/// The rows of the map of an environment: at least one, of one length.
pub(super) fn layout(environment: &Value) -> Result<Vec<&str>, String> {
    let layout = environment.get("layout").and_then(Value::as_array);
    let lines: Option<Vec<&str>> = layout.into_iter().flatten().map(Value::as_str).collect();
    let lines = lines.ok_or("layout must hold texts")?;
    let columns = lines.first().map_or(0, |line| line.len());
    let side = 1..=MAX_SIDE;
    if !side.contains(&lines.len()) || !side.contains(&columns) || lines.iter().any(|line| line.len() != columns) {
        return Err(format!("layout must hold 1 to {MAX_SIDE} rows of one length, from 1 to {MAX_SIDE} cells"));
    }
    Ok(lines)
}

/// A map: the kinds of its cells, and their rewards.
pub(crate) struct GridWorld {
    rows: usize,
    columns: usize,
    cells: Vec<u8>,
    wind: Vec<isize>,
    /// The reward of a step into each cell.
    rewards: Vec<f64>,
}

impl GridWorld {
    pub(crate) fn parse(environment: &Value) -> Result<Self, String> {
        let lines = layout(environment)?;
        let columns = lines[0].len();
        let cells: Vec<u8> = lines.concat().into_bytes();
        if cells.iter().any(|cell| !b".#SG".contains(cell)) {
            return Err("layout must consist of '.', '#', 'S' and 'G'".into());
        }
        if !cells.contains(&b'S') {
            return Err("layout must have a start, 'S'".into());
        }
        let wind = match environment.get("wind") {
            None => vec![0; columns],
            Some(wind) => {
                let shift = |shift| isize::try_from(integer(shift, MAX_SIDE as u32)?).ok();
                let shifts: Option<Vec<isize>> = wind.as_array().into_iter().flatten().map(shift).collect();
                shifts
                    .filter(|shifts| shifts.len() == columns)
                    .ok_or_else(|| format!("wind must hold {columns} integers from 0 to {MAX_SIDE}"))?
            }
        };
        let reward = |name: &str, default: f64| match environment.get(name) {
            None => Ok(default),
            Some(given) => {
                given.as_f64().ok_or_else(|| format!("{name} must be a finite number, got {}", shown(given)))
            }
        };
        let (step_reward, goal_reward) = (reward("step_reward", -1.0)?, reward("goal_reward", 0.0)?);
        let entered = cells.iter().map(|&cell| if cell == b'G' { goal_reward } else { step_reward }).collect();
        let mut grid = Self { rows: lines.len(), columns, cells, wind, rewards: entered };
        grid.set_rewards(environment.get("rewards"))?;
        Ok(grid)
    }

    fn set_rewards(&mut self, given: Option<&Value>) -> Result<(), String> {
        for entry in given.and_then(Value::as_array).into_iter().flatten() {
            let Some([row, column, reward]) = entry.as_array().map(Vec::as_slice) else {
                return Err("rewards must hold rows, columns and rewards".into());
            };
            let (row, column) = (integer(row, self.rows as u32 - 1), integer(column, self.columns as u32 - 1));
            let (Some(row), Some(column), Some(reward)) = (row, column, reward.as_f64()) else {
                return Err("rewards must name cells of the grid, with finite rewards".into());
            };
            self.rewards[row as usize * self.columns + column as usize] = reward;
        }
        Ok(())
    }

    pub(crate) fn columns(&self) -> usize {
        self.columns
    }

    /// Whether each cell is a wall.
    pub(crate) fn walls(&self) -> Vec<bool> {
        self.cells.iter().map(|&cell| cell == b'#').collect()
    }

    /// The next cell after a move.
    fn next_cell(&self, cell: usize, (down, right): (isize, isize)) -> usize {
        let (row, column) = (cell / self.columns, cell % self.columns);
        let moved = |index: usize, by: isize, count: usize| index.saturating_add_signed(by).min(count - 1);
        let next_row = moved(row, down - self.wind[column], self.rows);
        let next = next_row * self.columns + moved(column, right, self.columns);
        if self.cells[next] == b'#' { cell } else { next }
    }

    pub(crate) fn mdp(&self) -> Result<TabularMdp, String> {
        let states = 0..self.cells.len();
        let starts = self.cells.iter().map(|&cell| f64::from(u8::from(cell == b'S'))).sum::<f64>();
        let initial: Vec<f64> = self.cells.iter().map(|&cell| if cell == b'S' { 1.0 / starts } else { 0.0 }).collect();
        let outcome = |cell, direction| {
            let next = self.next_cell(cell, direction);
            let terminated = self.cells[next] == b'G';
            vec![Outcome {
                probability: 1.0,
                state: i64::try_from(next).unwrap_or(i64::MAX),
                reward: self.rewards[next],
                terminated,
            }]
        };
        let pairs: Vec<_> = states.flat_map(|cell| MOVES.map(|direction| outcome(cell, direction))).collect();
        TabularMdp::new(MOVES.len(), &initial, &pairs).map_err(|error| error.to_string())
    }
}
