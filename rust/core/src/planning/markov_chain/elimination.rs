//! Linear equations of a Markov chain, solved directly.

use crate::StopFlag;
use crate::planning::PlanningError;

/// A matrix I - γP after Gaussian elimination, which solves the equations for any right-hand side.
#[derive(Debug)]
pub(super) struct Eliminated {
    /// Row by row: the factors of the rows above, then the remaining entries of the row.
    entries: Vec<f64>,
    count: usize,
}

impl Eliminated {
    /// Eliminates a matrix of `count` rows and columns, row by row; `None` if it is singular to rounding. The matrix is
    /// diagonally dominant, so no rows need to be exchanged (N. Higham, *Accuracy and Stability of Numerical
    /// Algorithms*, 2nd ed., 2002, section 9.5).
    ///
    /// # Errors
    /// `Stopped` after `stop` was set.
    pub(super) fn new(mut entries: Vec<f64>, count: usize, stop: &StopFlag<'_>) -> Result<Option<Self>, PlanningError> {
        for column in 0..count {
            let (above, below) = entries.split_at_mut((column + 1) * count);
            let pivots = &above[column * count..];
            if pivots[column] <= 0.0 {
                return Ok(None);
            }
            for row in below.chunks_mut(count) {
                // Most entries are 0 if each state has few next states.
                if row[column] != 0.0 {
                    let factor = row[column] / pivots[column];
                    row[column] = factor;
                    for (entry, pivot) in row[column + 1..].iter_mut().zip(&pivots[column + 1..]) {
                        *entry -= factor * pivot;
                    }
                }
            }
            if stop.is_set() {
                return Err(PlanningError::Stopped);
            }
        }
        Ok(Some(Self { entries, count }))
    }

    /// Replaces a right-hand side by the solution.
    pub(super) fn solve(&self, sides: &mut [f64]) {
        for row in 0..self.count {
            let factors = &self.entries[row * self.count..][..row];
            let reduced = factors.iter().zip(&*sides).filter(|&(&factor, _)| factor != 0.0);
            sides[row] = reduced.fold(sides[row], |side, (factor, above)| side - factor * above);
        }
        for row in (0..self.count).rev() {
            let entries = &self.entries[row * self.count..][..self.count];
            let known = entries[row + 1..].iter().zip(&sides[row + 1..]);
            let known = known.fold(0.0, |sum, (entry, side)| sum + entry * side);
            sides[row] = (sides[row] - known) / entries[row];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equations_are_solved() {
        // x = 1 + y / 2, y = 2 + x / 4 + z / 4, z = -1 + y
        let matrix = vec![1.0, -0.5, 0.0, -0.25, 1.0, -0.25, 0.0, -1.0, 1.0];
        let mut sides = [1.0, 2.0, -1.0];
        Eliminated::new(matrix, 3, &StopFlag::new()).expect("not stopped").expect("regular").solve(&mut sides);
        for (found, expected) in sides.into_iter().zip([2.6, 3.2, 2.2]) {
            assert!((found - expected).abs() < 1e-15, "{found} {expected}");
        }
    }

    #[test]
    fn a_singular_matrix_has_no_solution() {
        let eliminated = Eliminated::new(vec![1.0, -1.0, -1.0, 1.0], 2, &StopFlag::new());
        assert!(eliminated.expect("not stopped").is_none());
    }
}
