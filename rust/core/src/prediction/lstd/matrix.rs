//! Products and equations of a square matrix, which is stored row by row.

/// The number of rows whose sums are computed side by side, so that an addition need not wait for the one before.
const ROWS: usize = 4;

/// The product of a matrix and a vector, with sums from left to right.
pub(super) fn product(sums: &mut [f64], matrix: &[f64], vector: &[f64]) {
    let width = vector.len();
    let mut chunks = sums.chunks_exact_mut(ROWS).zip(matrix.chunks_exact(ROWS * width));
    for (sums, rows) in &mut chunks {
        let rows: [&[f64]; ROWS] = std::array::from_fn(|row| &rows[row * width..][..width]);
        let mut parts = rows.map(|row| row[0] * vector[0]);
        for (index, factor) in vector.iter().enumerate().skip(1) {
            for (part, row) in parts.iter_mut().zip(rows) {
                *part += row[index] * factor;
            }
        }
        sums.copy_from_slice(&parts);
    }
    let done = width / ROWS * ROWS;
    for (sum, row) in sums[done..].iter_mut().zip(matrix[done * width..].chunks_exact(width)) {
        *sum = row.iter().zip(vector).skip(1).fold(row[0] * vector[0], |sum, (number, factor)| sum + number * factor);
    }
}

/// Solves rows · x = b by Gaussian elimination with partial pivoting, in place. Returns `false` if the matrix is singular.
pub(super) fn solve(x: &mut [f64], rows: &mut [f64], b: &mut [f64]) -> bool {
    let width = b.len();
    for column in 0..width {
        let size = |row: usize| rows[row * width + column].abs();
        let pivot = (column + 1..width).fold(column, |best, row| if size(row) > size(best) { row } else { best });
        if size(pivot) == 0.0 {
            return false;
        }
        b.swap(column, pivot);
        let (above, below) = rows.split_at_mut((column + 1) * width);
        let first = &mut above[column * width..];
        if pivot != column {
            first.swap_with_slice(&mut below[(pivot - column - 1) * width..][..width]);
        }
        let (above, rest) = b.split_at_mut(column + 1);
        for (row, number) in below.chunks_exact_mut(width).zip(rest) {
            let factor = row[column] / first[column];
            for (number, first) in row[column..].iter_mut().zip(&first[column..]) {
                *number -= factor * first;
            }
            *number -= factor * above[column];
        }
    }
    for column in (0..width).rev() {
        let solved = b[column] / rows[column * width + column];
        x[column] = solved;
        for (number, row) in b[..column].iter_mut().zip(rows.chunks_exact(width)) {
            *number -= row[column] * solved;
        }
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equations_are_solved_if_the_matrix_is_not_singular() {
        // The first pivot is 0.
        let mut matrix = [0.0, 2.0, 1.0, 1.0, -1.0, 3.0, 4.0, 0.0, -2.0];
        let expected = [3.0, -1.0, 2.0];
        let (mut b, mut found) = ([0.0; 3], [0.0; 3]);
        product(&mut b, &matrix, &expected);
        assert!(solve(&mut found, &mut matrix, &mut b));
        for (found, expected) in found.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-14);
        }
        assert!(!solve(&mut found, &mut [1.0, 2.0, 3.0, 2.0, 4.0, 6.0, 0.0, 0.0, 1.0], &mut b));
    }

    #[test]
    fn the_sums_of_several_rows_are_those_of_each() {
        let matrix: Vec<f64> = (0..36).map(|index| f64::from(index).sin()).collect();
        let vector: Vec<f64> = (0..6).map(|index| f64::from(index).cos()).collect();
        let mut sums = [0.0; 6];
        product(&mut sums, &matrix, &vector);
        for (row, sum) in matrix.chunks(6).zip(sums) {
            let products = row.iter().zip(&vector).map(|(number, factor)| number * factor);
            assert_eq!(sum, products.reduce(|sum, product| sum + product).unwrap_or_default());
        }
    }
}
