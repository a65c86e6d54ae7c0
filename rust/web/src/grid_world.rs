//! Grid worlds as they are painted: the transition table of a map. `qtab.book.grid_world` makes the same in Python.

use qtab_core::envs::tabular::{Outcome, TabularMdp};

use crate::json::Json;

/// The longest side of a grid, in cells.
pub(crate) const MAX_SIDE: usize = 40;
/// Up, right, down, left: how the row and the column change.
const MOVES: [(i64, i64); 4] = [(-1, 0), (0, 1), (1, 0), (0, -1)];

/// A map: what its cells are, and what they earn.
pub(crate) struct GridWorld {
    rows: usize,
    columns: usize,
    cells: Vec<u8>,
    wind: Vec<u32>,
    /// The reward of a step into each cell.
    rewards: Vec<f64>,
}

impl GridWorld {
    pub(crate) fn parse(environment: &Json) -> Result<Self, String> {
        let layout = environment.get("layout").and_then(Json::array).unwrap_or_default();
        let lines: Option<Vec<&str>> = layout.iter().map(Json::text).collect();
        let lines = lines.ok_or("layout must hold texts")?;
        let columns = lines.first().map_or(0, |line| line.len());
        let side = 1..=MAX_SIDE;
        if !side.contains(&lines.len()) || !side.contains(&columns) || lines.iter().any(|line| line.len() != columns) {
            return Err(format!("layout must hold 1 to {MAX_SIDE} rows of one length, from 1 to {MAX_SIDE} cells"));
        }
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
                let shifts = wind.array().unwrap_or_default().iter().map(|shift| shift.integer(MAX_SIDE as u32));
                let shifts: Option<Vec<u32>> = shifts.collect();
                shifts
                    .filter(|shifts| shifts.len() == columns)
                    .ok_or_else(|| format!("wind must hold {columns} integers from 0 to {MAX_SIDE}"))?
            }
        };
        let reward = |name: &str, default: f64| match environment.get(name) {
            None => Ok(default),
            Some(given) => {
                given.number().ok_or_else(|| format!("{name} must be a finite number, got {}", given.shown()))
            }
        };
        let (step_reward, goal_reward) = (reward("step_reward", -1.0)?, reward("goal_reward", 0.0)?);
        let entered = cells.iter().map(|&cell| if cell == b'G' { goal_reward } else { step_reward }).collect();
        let mut grid = Self { rows: lines.len(), columns, cells, wind, rewards: entered };
        grid.set_rewards(environment.get("rewards"))?;
        Ok(grid)
    }

    fn set_rewards(&mut self, given: Option<&Json>) -> Result<(), String> {
        for entry in given.and_then(Json::array).unwrap_or_default() {
            let Some([row, column, reward]) = entry.array() else {
                return Err("rewards must hold rows, columns and rewards".into());
            };
            let (row, column) = (row.integer(self.rows as u32 - 1), column.integer(self.columns as u32 - 1));
            let (Some(row), Some(column), Some(reward)) = (row, column, reward.number()) else {
                return Err("rewards must name cells of the grid, with finite rewards".into());
            };
            self.rewards[row as usize * self.columns + column as usize] = reward;
        }
        Ok(())
    }

    pub(crate) fn columns(&self) -> usize {
        self.columns
    }

    /// Which cells are walls.
    pub(crate) fn walls(&self) -> Vec<bool> {
        self.cells.iter().map(|&cell| cell == b'#').collect()
    }

    /// The cell that a move leads to.
    fn next_cell(&self, cell: usize, (down, right): (i64, i64)) -> usize {
        let (row, column) = (cell / self.columns, cell % self.columns);
        let clip = |index: i64, count: usize| index.clamp(0, count as i64 - 1) as usize;
        let next_row = clip(row as i64 + down - i64::from(self.wind[column]), self.rows);
        let next = next_row * self.columns + clip(column as i64 + right, self.columns);
        if self.cells[next] == b'#' { cell } else { next }
    }

    pub(crate) fn mdp(&self) -> Result<TabularMdp, String> {
        let states = 0..self.cells.len();
        let starts = self.cells.iter().filter(|&&cell| cell == b'S').count() as f64;
        let initial: Vec<f64> = self.cells.iter().map(|&cell| if cell == b'S' { 1.0 / starts } else { 0.0 }).collect();
        let outcome = |cell, direction| {
            let next = self.next_cell(cell, direction);
            let terminated = self.cells[next] == b'G';
            vec![Outcome { probability: 1.0, state: next as i64, reward: self.rewards[next], terminated }]
        };
        let pairs: Vec<_> = states.flat_map(|cell| MOVES.map(|direction| outcome(cell, direction))).collect();
        TabularMdp::new(MOVES.len(), &initial, &pairs).map_err(|error| error.to_string())
    }
}
