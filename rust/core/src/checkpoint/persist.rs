//! The trait of all values in a checkpoint, for numbers and for collections of fixed length.

use super::{Checkpoint, CheckpointError};

/// A value that changes during a run, and therefore belongs in a checkpoint.
pub trait Persist {
    /// Saves the value, or replaces it by the saved one.
    ///
    /// # Errors
    /// If the bytes are damaged, or belong to another run. The value is then unspecified.
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
            _ => return Err(CheckpointError::Invalid("boolean")),
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

/// The elements; their number must be known.
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

/// Saves and restores nothing.
impl Persist for () {
    fn persist(&mut self, _checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        Ok(())
    }
}

/// Several values, one after another.
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
