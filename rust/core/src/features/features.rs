//! The trait of all features.

use super::OutOfBounds;

/// The active rows of an observation, which are stored and passed by value.
pub trait ActiveRows: Copy + AsRef<[u32]> + for<'a> TryFrom<&'a [u32]> {}

impl<R: Copy + AsRef<[u32]> + for<'a> TryFrom<&'a [u32]>> ActiveRows for R {}

/// Maps an observation to the active rows of a Q table: one row for a grid, several for tile coding.
pub trait Features<O: ?Sized> {
    /// The active rows, in the order in which a learner sums their values.
    type Active: ActiveRows;

    /// Whether the active rows are computed in vector registers, so that code which finds them is worth compiling for wide
    /// ones too. [`active_rows`](Self::active_rows) is then always inlined.
    const USES_VECTORS: bool = false;

    /// The active rows of an observation.
    ///
    /// # Errors
    /// The observation has no row. A row index never wraps around, and is clamped only where the features say so.
    fn active_rows(&self, observation: &O) -> Result<Self::Active, OutOfBounds>;

    /// [`active_rows`](Self::active_rows), which writes the rows to `active`. Many rows are then copied once.
    ///
    /// # Errors
    /// As for `active_rows`.
    #[expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]
    #[inline(always)]
    fn write_active_rows(&self, observation: &O, active: &mut Self::Active) -> Result<(), OutOfBounds> {
        *active = self.active_rows(observation)?;
        Ok(())
    }

    /// The number of rows of the table.
    fn len(&self) -> usize;

    /// Whether the table has no rows.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
