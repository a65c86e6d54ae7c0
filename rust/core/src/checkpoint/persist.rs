//! The trait of all values in a checkpoint, for numbers and for collections of fixed length.

use super::{Checkpoint, CheckpointError};

/// A value that changes during a run, and therefore belongs in a checkpoint.
///
/// Numbers, booleans, tuples, arrays and options of such values have it. [`persist_struct!`](crate::persist_struct) and
/// [`persist_enum!`](crate::persist_enum) implement it for the state of an environment.
#[diagnostic::on_unimplemented(
    message = "`{Self}` cannot be saved in a checkpoint",
    note = "implement it in one line: `qtab_core::persist_struct!(State {{ field, other_field }});`"
)]
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

persist_number!(u8, u16, u32, u64, u128, i8, i16, i32, i64, i128, f32, f64);

/// Numbers of the machine's size, in 64 bits.
macro_rules! persist_sized {
    ($($number:ty as $stored:ty),*) => {$(
        impl Persist for $number {
            fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
                let mut number = *self as $stored;
                number.persist(checkpoint)?;
                *self = Self::try_from(number).map_err(|_| CheckpointError::Invalid("integer"))?;
                Ok(())
            }
        }
    )*};
}

persist_sized!(usize as u64, isize as i64);

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
persist_tuple!(A, B, C, D, E, F);
persist_tuple!(A, B, C, D, E, F, G);
persist_tuple!(A, B, C, D, E, F, G, H);

impl<T: Persist + ?Sized> Persist for &mut T {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        (**self).persist(checkpoint)
    }
}
