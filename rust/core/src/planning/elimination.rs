//! Linear equations of a Markov chain, solved directly.

use crate::StopFlag;

use super::PlanningError;

/// Gaussian elimination of I - γP, row by row, and of the right-hand sides, which become the solution. The matrix is
/// diagonally dominant, so that no rows need to be exchanged (N. Higham, *Accuracy and Stability of Numerical
/// Algorithms*, 2nd ed., 2002, section 9.5).
///
/// # Errors
/// `NotConverged` if the matrix is singular to rounding; `Stopped` after `stop` was set.
///
/// # Panics
/// If the matrix does not have as many rows and columns as there are right-hand sides.
pub(super) fn eliminate(matrix: &mut [f64], sides: &mut [f64], stop: &StopFlag<'_>) -> Result<(), PlanningError> {
    let count = sides.len();
    assert_eq!(matrix.len(), count * count, "the matrix must be square");
    for column in 0..count {
        let (above, below) = matrix.split_at_mut((column + 1) * count);
        let pivots = &above[column * count..];
        if pivots[column] <= 0.0 {
            return Err(PlanningError::NotConverged);
        }
        for (row, row_entries) in below.chunks_mut(count).enumerate() {
            // Most entries are 0, where few states follow each.
            if row_entries[column] != 0.0 {
                let factor = row_entries[column] / pivots[column];
                for (entry, pivot) in row_entries[column + 1..].iter_mut().zip(&pivots[column + 1..]) {
                    *entry -= factor * pivot;
                }
                sides[column + 1 + row] -= factor * sides[column];
            }
        }
        if stop.is_set() {
            return Err(PlanningError::Stopped);
        }
    }
    for row in (0..count).rev() {
        let entries = &matrix[row * count..][..count];
        let known = entries[row + 1..].iter().zip(&sides[row + 1..]).fold(0.0, |sum, (entry, side)| sum + entry * side);
        sides[row] = (sides[row] - known) / entries[row];
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equations_are_solved() {
        // x = 1 + y / 2, y = 2 + x / 4 + z / 4, z = -1 + y
        let mut matrix = [1.0, -0.5, 0.0, -0.25, 1.0, -0.25, 0.0, -1.0, 1.0];
        let mut sides = [1.0, 2.0, -1.0];
        eliminate(&mut matrix, &mut sides, &StopFlag::new()).expect("regular");
        for (found, expected) in sides.into_iter().zip([2.6, 3.2, 2.2]) {
            assert!((found - expected).abs() < 1e-15, "{found} {expected}");
        }
    }

    #[test]
    fn a_singular_matrix_is_an_error() {
        let mut matrix = [1.0, -1.0, -1.0, 1.0];
        assert_eq!(eliminate(&mut matrix, &mut [1.0, 0.0], &StopFlag::new()), Err(PlanningError::NotConverged));
    }
}
