//! The trait of what a checkpoint holds, for numbers and for collections of fixed length.

use super::{Checkpoint, CheckpointError};
use crate::features::{ActiveRows, MAX_TILINGS};

/// A value that changes during a run, so that a checkpoint must hold it.
pub trait Persist {
    /// Saves the value, or replaces it by the one that was saved.
    ///
    /// # Errors
    /// The bytes are damaged, or belong to another run. The value is then unspecified.
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError>;
}

/// Numbers, by their little-endian bytes.
macro_rules! persist_number {
    ($($number:ty),*) => {$(
        impl Persist for $number {
            fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
                *self = Self::from_le_bytes(checkpoint.bytes(self.to_le_bytes())?);
                Ok(())
            }
        }
    )*};
}

persist_number!(u8, u32, u64, i64, f32, f64);

impl Persist for bool {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        *self = match checkpoint.bytes([u8::from(*self)])? {
            [0] => false,
            [1] => true,
            _ => return Err(CheckpointError::Invalid("true or false")),
        };
        Ok(())
    }
}

impl<T: Persist + Default> Persist for Option<T> {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        let mut present = self.is_some();
        present.persist(checkpoint)?;
        if present {
            return self.get_or_insert_default().persist(checkpoint);
        }
        *self = None;
        Ok(())
    }
}

/// The elements; how many there are must be known.
impl<T: Persist> Persist for [T] {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.iter_mut().try_for_each(|element| element.persist(checkpoint))
    }
}

impl<T: Persist, const N: usize> Persist for [T; N] {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.as_mut_slice().persist(checkpoint)
    }
}

/// Nothing.
impl Persist for () {
    fn persist(&mut self, _checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        Ok(())
    }
}

/// Several values, one after the other.
macro_rules! persist_tuple {
    ($($name:ident),*) => {
        impl<$($name: Persist),*> Persist for ($($name,)*) {
            #[expect(non_snake_case, reason = "a value is named as its type")]
            fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
                let ($($name,)*) = self;
                $($name.persist(checkpoint)?;)*
                Ok(())
            }
        }
    };
}

persist_tuple!(A, B);
persist_tuple!(A, B, C);
persist_tuple!(A, B, C, D);
persist_tuple!(A, B, C, D, E);

impl<T: Persist + ?Sized> Persist for &mut T {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        (**self).persist(checkpoint)
    }
}

/// Saves active rows, or returns those that were saved; `rows` may be `None` while restoring. Each is less than `num_rows`.
///
/// # Errors
/// As for any value.
pub fn persist_rows<R: ActiveRows>(
    rows: Option<R>,
    num_rows: usize,
    checkpoint: &mut Checkpoint<'_>,
) -> Result<R, CheckpointError> {
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
