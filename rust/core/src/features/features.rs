//! The traits of features, and their error.

use std::error::Error;
use std::fmt;

use super::{ActiveFeatures, LaneRows, MAX_TILINGS};
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::errors::BuildError;
use crate::simd::{F32s, Simd};

/// The active rows of an observation, which are stored and passed by value.
pub trait ActiveRows: Copy + ActiveFeatures + for<'a> TryFrom<&'a [u32]> {}

impl<R: Copy + ActiveFeatures + for<'a> TryFrom<&'a [u32]>> ActiveRows for R {}

/// Maps an observation to the active rows of a Q table: one row for a grid, several for tile coding.
pub trait Features<O: ?Sized> {
    /// The active rows, in the order in which a learner sums their values: `[u32; 1]` for a grid, `[u32; N]` for `N`
    /// rows.
    type Active: ActiveRows;

    /// Whether the active rows are computed in vector registers, so that code that computes them is worth compiling for
    /// wide registers too. [`active_rows`](Self::active_rows) is then always inlined.
    const USES_VECTORS: bool = false;

    /// The active rows of an observation.
    ///
    /// # Errors
    /// The observation has no row. A row index never wraps around, and is clamped only by features that document it.
    fn active_rows(&self, observation: &O) -> Result<Self::Active, OutOfBounds>;

    /// Like [`active_rows`](Self::active_rows), but writes the rows to `active`, so that many rows are copied only
    /// once.
    ///
    /// # Errors
    /// As for `active_rows`.
    #[inline(always)]
    fn write_active_rows(&self, observation: &O, active: &mut Self::Active) -> Result<(), OutOfBounds> {
        *active = self.active_rows(observation)?;
        Ok(())
    }

    /// The number of rows of the table.
    fn len(&self) -> usize;

    /// The number that divides the learning rate of each row, if this is not the same for all rows; empty otherwise.
    fn step_size_divisors(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Checks what the constructors do not: that the bounds of each component are in order.
    /// [`TrainerBuilder::build`](crate::TrainerBuilder::build) calls it.
    ///
    /// # Errors
    /// `Invalid`, with the setting that is wrong.
    fn check(&self) -> Result<(), BuildError> {
        Ok(())
    }

    /// Whether the table has no rows.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl<O: ?Sized, F: Features<O>> Features<O> for &F {
    type Active = F::Active;

    const USES_VECTORS: bool = F::USES_VECTORS;

    #[inline(always)]
    fn active_rows(&self, observation: &O) -> Result<F::Active, OutOfBounds> {
        F::active_rows(self, observation)
    }

    #[inline(always)]
    fn write_active_rows(&self, observation: &O, active: &mut F::Active) -> Result<(), OutOfBounds> {
        F::write_active_rows(self, observation, active)
    }

    fn len(&self) -> usize {
        F::len(self)
    }

    fn step_size_divisors(&self) -> Vec<f64> {
        F::step_size_divisors(self)
    }

    fn check(&self) -> Result<(), BuildError> {
        F::check(self)
    }
}

/// Features of `M` components that find the active rows of several observations at once.
pub trait BatchFeatures<const M: usize>: Features<[f32; M]> + Clone + PartialEq {
    /// The active rows in the representation of a lane.
    type ActiveInLane: LaneRows<Active = Self::Active>;

    /// Writes the active rows of the observation in each lane, given component by component. Returns `false` if an
    /// observation has no row; the rows written are then unspecified.
    #[must_use]
    fn write_active_rows_batch<S: Simd, const K: usize>(
        &self,
        simd: S,
        observations: [F32s<S, K>; M],
        active: &mut [Self::ActiveInLane; K],
    ) -> bool;
}

/// An observation that the features have no row for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutOfBounds {
    /// The index of the component of the observation.
    pub axis: usize,
    /// The value of that component.
    pub value: f64,
}

impl fmt::Display for OutOfBounds {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "observation[{}] is {}, outside the observation space", self.axis, self.value)
    }
}

impl Error for OutOfBounds {}

/// Saves active rows, or returns those that were saved; `rows` may be `None` while restoring. Each is less than `num_rows`.
/// Weighted features are saved as their values, one for each row of the table.
///
/// # Errors
/// As for any value.
pub fn persist_rows<R: ActiveRows>(
    rows: Option<R>,
    num_rows: usize,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<R, CheckpointError> {
    if R::WEIGHTED {
        let mut values = rows.map_or_else(|| vec![0.0; num_rows], |rows| rows.values().to_vec());
        values.as_mut_slice().persist(checkpoint)?;
        checkpoint.check(values.iter().all(|value| value.is_finite()), "value of a feature")?;
        return R::from_values(&values).ok_or(CheckpointError::Invalid("number of features"));
    }
    let mut numbers = [0; MAX_TILINGS];
    let mut count = 0;
    if let Some(rows) = &rows {
        count = rows.as_ref().len();
        numbers[..count].copy_from_slice(rows.as_ref());
    }
    checkpoint.index(&mut count, MAX_TILINGS + 1, "number of active rows")?;
    for row in &mut numbers[..count] {
        checkpoint.index_u32(row, num_rows, "row")?;
    }
    R::try_from(&numbers[..count]).map_err(|_| CheckpointError::Invalid("number of active rows"))
}
