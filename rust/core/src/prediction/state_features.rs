//! The features of states: the active rows of each, or a vector of numbers.

use crate::features::{ActiveFeatures, assert_binary};
use crate::memory::{AllocationError, RunMemory, collect, reserve};
use crate::numeric::{sum, sum_products};

/// A method that looks back further than this stores the features of the whole episode.
const MOST_KEPT: usize = 1024;

/// The features x(s) of states. A method identifies a state by its number.
///
/// Binary features are the active rows of a state, the same number for each; weighted features are a number for each weight
/// (see [`ActiveFeatures`]).
#[derive(Debug, PartialEq)]
pub struct StateFeatures {
    /// The active rows of binary features, those of state 0 first.
    rows: Vec<u32>,
    /// The values of weighted features, those of state 0 first.
    vectors: Vec<f64>,
    /// The number of rows or values of a state.
    n_active: usize,
    n_weights: usize,
    is_weighted: bool,
    /// Whether each state has one active row.
    has_single_rows: bool,
    /// `None` for states that the task numbers: the active row in the task is then the number of a state.
    visits: Option<Visits>,
}

/// The visits of an episode, which number states that have no numbers of their own.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Visits {
    /// The number of states stored; `None` for the whole episode.
    kept: Option<u32>,
    /// The number of the state visited last.
    last: u32,
}

impl StateFeatures {
    fn new(n_active: usize, n_weights: usize, is_weighted: bool) -> Self {
        let has_single_rows = n_active == 1 && !is_weighted;
        Self { rows: Vec::new(), vectors: Vec::new(), n_active, n_weights, is_weighted, has_single_rows, visits: None }
    }

    /// The binary features of numbered states: a table, state aggregation, tile coding. `rows` holds `n_active` rows for
    /// each state, those of state 0 first, each less than `n_weights`; `None` if it does not.
    pub fn of_states(rows: Vec<u32>, n_active: usize, n_weights: usize) -> Option<Self> {
        let fits =
            n_active > 0 && rows.len().is_multiple_of(n_active) && rows.iter().all(|&row| (row as usize) < n_weights);
        fits.then_some(Self { rows, ..Self::new(n_active, n_weights, false) })
    }

    /// The weighted features of numbered states. `vectors` holds `n_weights` finite numbers for each state, those of state
    /// 0 first; `None` if it does not.
    pub fn weighted(vectors: Vec<f64>, n_weights: usize) -> Option<Self> {
        let fits =
            n_weights > 0 && vectors.len().is_multiple_of(n_weights) && vectors.iter().all(|value| value.is_finite());
        fits.then_some(Self { vectors, ..Self::new(n_weights, n_weights, true) })
    }

    /// The binary features of states without numbers: those of the observations of an episode. Stores the rows of the last
    /// state, the next one, and `look_back` states before them; `None` stores all.
    ///
    /// # Errors
    /// `OutOfMemory`.
    pub fn of_visits(n_active: usize, n_weights: usize, look_back: Option<usize>) -> Result<Self, AllocationError> {
        let mut features = Self::new(n_active, n_weights, false);
        let count = features.keep(look_back);
        reserve(&mut features.rows, count)?;
        features.rows.resize(count, 0);
        Ok(features)
    }

    /// Like [`of_visits`](Self::of_visits), for weighted features.
    ///
    /// # Errors
    /// `OutOfMemory`.
    pub fn of_weighted_visits(n_weights: usize, look_back: Option<usize>) -> Result<Self, AllocationError> {
        let mut features = Self::new(n_weights, n_weights, true);
        let count = features.keep(look_back);
        reserve(&mut features.vectors, count)?;
        features.vectors.resize(count, 0.0);
        Ok(features)
    }

    /// Numbers the visits. Returns the number of rows or values to store.
    fn keep(&mut self, look_back: Option<usize>) -> usize {
        let kept = look_back.filter(|&count| count <= MOST_KEPT).map(|count| count as u32 + 2);
        self.visits = Some(Visits { kept, last: 0 });
        kept.map_or(0, |kept| kept as usize * self.n_active)
    }

    /// A copy.
    ///
    /// # Errors
    /// `OutOfMemory`.
    pub fn try_clone(&self) -> Result<Self, AllocationError> {
        let rows = collect(self.rows.iter().copied())?;
        Ok(Self { rows, vectors: collect(self.vectors.iter().copied())?, ..*self })
    }

    /// The number of states; 0 if they are not numbered.
    pub fn num_states(&self) -> usize {
        if self.visits.is_some() { 0 } else { self.rows.len().max(self.vectors.len()) / self.n_active }
    }

    /// The number of active rows of a state, or of values of weighted features.
    #[inline]
    pub fn n_active(&self) -> usize {
        self.n_active
    }

    /// The number of weights.
    pub fn n_weights(&self) -> usize {
        self.n_weights
    }

    /// Whether the features have values other than 1.
    pub fn is_weighted(&self) -> bool {
        self.is_weighted
    }

    /// The active rows of a state with binary features.
    #[inline]
    pub fn of(&self, state: u32) -> &[u32] {
        &self.rows[state as usize * self.n_active..][..self.n_active]
    }

    /// The row of a state with one active row; the first row otherwise.
    #[inline]
    pub fn first(&self, state: u32) -> usize {
        self.rows[state as usize * self.n_active] as usize
    }

    /// The row of a state if each state has one active row, so that its value is a weight; `None` otherwise.
    #[inline]
    pub fn single_row(&self, state: u32) -> Option<usize> {
        self.has_single_rows.then(|| self.rows[state as usize] as usize)
    }

    /// The values of a state with weighted features; `None` for binary ones.
    #[inline]
    pub fn vector(&self, state: u32) -> Option<&[f64]> {
        self.is_weighted.then(|| &self.vectors[state as usize * self.n_active..][..self.n_active])
    }

    /// wᵀx(s): the sum of the weights of the active rows from left to right, or of the products of weighted features in the
    /// order of [`ActiveFeatures`].
    pub fn dot(&self, state: u32, weights: &[f64]) -> f64 {
        match self.vector(state) {
            None => sum(self.of(state).iter().map(|&row| weights[row as usize])),
            Some(x) => {
                let weights = &weights[..x.len()];
                sum_products(x, |row| [weights[row]])[0]
            }
        }
    }

    /// Begins an episode.
    pub(super) fn begin(&mut self) {
        let Some(visits) = &mut self.visits else { return };
        visits.last = u32::MAX;
        if visits.kept.is_none() {
            self.rows.clear();
            self.vectors.clear();
        }
    }

    /// The number of the next state of the episode, given its features in the task.
    ///
    /// # Panics
    /// If only one of the task and these features is weighted.
    pub(super) fn visit<R: ActiveFeatures>(&mut self, active: &R) -> u32 {
        let Some(Visits { kept, last }) = &mut self.visits else {
            assert_binary::<R>();
            return active.as_ref()[0];
        };
        *last = last.wrapping_add(1);
        if let Some(kept) = *kept {
            *last = if *last == kept { 0 } else { *last };
        }
        let (last, start) = (*last, kept.map(|_| *last as usize * self.n_active));
        if self.is_weighted {
            store(&mut self.vectors, start, active.values(), self.n_active);
        } else {
            assert_binary::<R>();
            store(&mut self.rows, start, active.as_ref(), self.n_active);
        }
        last
    }

    /// Reserves memory for this many more states.
    ///
    /// # Errors
    /// `OutOfMemory`, `LimitReached`.
    pub(super) fn reserve(&mut self, states: u64, memory: &mut RunMemory) -> Result<(), AllocationError> {
        let Some(Visits { kept: None, .. }) = self.visits else { return Ok(()) };
        // Each call of the trainer may begin an episode.
        let states = usize::try_from(states).unwrap_or(usize::MAX).saturating_add(1);
        let count = states.saturating_mul(self.n_active);
        if self.is_weighted { memory.reserve(&mut self.vectors, count) } else { memory.reserve(&mut self.rows, count) }
    }
}

/// Stores the rows or the values of a state, `n_active` of them, from an index on, or at the end.
#[inline]
fn store<T: Copy>(numbers: &mut Vec<T>, start: Option<usize>, active: &[T], n_active: usize) {
    match start {
        Some(start) => numbers[start..][..n_active].copy_from_slice(active),
        None => numbers.extend_from_slice(active),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::FeatureVector;

    #[test]
    fn the_last_states_are_kept_and_all_of_them_where_a_method_needs_them() {
        for look_back in [Some(2), Some(MOST_KEPT + 1), None] {
            let mut features = StateFeatures::of_visits(2, 100, look_back).expect("memory suffices");
            let mut vectors = StateFeatures::of_weighted_visits(2, look_back).expect("memory suffices");
            for episode in 0..2 {
                features.begin();
                vectors.begin();
                let mut states = Vec::new();
                for visit in 0..=40 {
                    states.push(features.visit(&[episode + visit, 50 + visit]));
                    let Some(values) = FeatureVector::<2>::new(&[f64::from(episode), f64::from(visit)]) else {
                        unreachable!("there is room")
                    };
                    assert_eq!(vectors.visit(&values), states[visit as usize]);
                    for visit in visit.saturating_sub(3)..=visit {
                        let state = states[visit as usize];
                        assert_eq!(features.of(state), [episode + visit, 50 + visit]);
                        assert_eq!(vectors.vector(state), Some([f64::from(episode), f64::from(visit)].as_slice()));
                    }
                }
                assert!(look_back == Some(2) || features.of(states[1]) == [episode + 1, 51]);
            }
        }
    }

    #[test]
    fn a_single_weighted_feature_is_no_table() {
        let Some(features) = StateFeatures::weighted(vec![2.0, -3.0], 1) else { unreachable!("they fit") };
        assert_eq!(features.single_row(0), None);
        assert_eq!((features.num_states(), features.n_weights(), features.n_active()), (2, 1, 1));
        assert_eq!(features.dot(1, &[0.5]), -1.5);
        assert_eq!(StateFeatures::weighted(vec![f64::NAN], 1), None);
        assert_eq!(StateFeatures::weighted(vec![1.0; 3], 2), None);
    }
}
