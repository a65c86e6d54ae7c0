//! Functions of the action values in the lanes of a batch.

use crate::features::LaneRows;
use crate::q_table::sum_rows;
use crate::simd::{F64s, Simd, U64s, map};

/// The values of the active rows of each lane, action by action.
#[inline(always)]
pub(super) fn values_of_rows<S: Simd, R: LaneRows, const N: usize, const K: usize>(
    simd: S,
    tables: &[&mut [[f64; N]]; K],
    rows: &[R; K],
) -> [F64s<S, K>; N] {
    if R::IS_SINGLE {
        return F64s::columns(simd, std::array::from_fn(|lane| &tables[lane][rows[lane].first()]));
    }
    let mut values = [[0.0; K]; N];
    for lane in 0..K {
        let sums = sum_rows(rows[lane].indices().map(|row| tables[lane][row]));
        for (values, sum) in values.iter_mut().zip(sums) {
            values[lane] = sum;
        }
    }
    map(values, |values| F64s::new(simd, values))
}

/// The value of an action in each lane.
#[inline(always)]
pub(super) fn values_of<S: Simd, const N: usize, const K: usize>(
    values: &[F64s<S, K>; N],
    actions: U64s<S, K>,
) -> F64s<S, K> {
    let mut chosen = values[0];
    for (action, &values) in values.iter().enumerate().skip(1) {
        chosen = actions.equal(action as u64).select(values, chosen);
    }
    chosen
}

/// The largest value in each lane.
#[inline(always)]
pub(super) fn largest<S: Simd, const N: usize, const K: usize>(values: &[F64s<S, K>; N]) -> F64s<S, K> {
    let mut largest = values[0];
    for values in &values[1..] {
        largest = values.larger(largest);
    }
    largest
}

/// The index of the largest value in each lane, the first one if there are several: `np.argmax`.
#[inline(always)]
pub(super) fn argmax_in_lanes<S: Simd, const N: usize, const K: usize>(
    simd: S,
    values: &[F64s<S, K>; N],
) -> U64s<S, K> {
    let (mut best, mut largest) = (U64s::splat(simd, 0), values[0]);
    for (index, &values) in values.iter().enumerate().skip(1) {
        best = values.greater(largest).select(U64s::splat(simd, index as u64), best);
        largest = values.larger(largest);
    }
    best
}

/// The expected value in each lane, under a policy with these probabilities of the greedy action and of each other
/// action: [`EpsilonGreedy::expected_value`](crate::policies::Policy::expected_value).
#[inline(always)]
pub(super) fn expected_values<S: Simd, const N: usize, const K: usize>(
    simd: S,
    values: &[F64s<S, K>; N],
    greedy_probability: F64s<S, K>,
    other_probability: F64s<S, K>,
) -> F64s<S, K> {
    let best = argmax_in_lanes(simd, values);
    let mut terms = *values;
    for (action, term) in terms.iter_mut().enumerate() {
        *term = best.equal(action as u64).select(greedy_probability, other_probability) * *term;
    }
    let mut sum = terms[0];
    for &term in &terms[1..] {
        sum = sum + term;
    }
    sum
}
