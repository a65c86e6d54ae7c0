//! Writing and reading a checkpoint, with one description of its contents.

use std::error::Error;
use std::fmt::{self, Display, Formatter};

use super::Persist;

/// A checkpoint that is being written or read. The same calls do both, so that the two cannot disagree: a value passed
/// to the checkpoint is appended to the bytes, or replaced by the value that they hold.
#[derive(Debug)]
pub struct Checkpoint<'a>(Mode<'a>);

#[derive(Debug)]
enum Mode<'a> {
    Save(&'a mut Vec<u8>),
    /// The bytes left to read.
    Restore(&'a [u8]),
}

/// The reason why a checkpoint cannot be written or read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The bytes end too early.
    Truncated,
    /// There are bytes after the end.
    TrailingBytes,
    /// A value that is invalid in this run; the text names it.
    Invalid(&'static str),
    /// The bytes do not fit into memory.
    OutOfMemory,
}

impl Display for CheckpointError {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Truncated => write!(f, "it ends too early"),
            Self::TrailingBytes => write!(f, "it is too long"),
            Self::Invalid(what) => write!(f, "it holds an impossible {what}"),
            Self::OutOfMemory => write!(f, "it does not fit into memory"),
        }
    }
}

impl Error for CheckpointError {}

impl<'a> Checkpoint<'a> {
    /// A checkpoint that appends to these bytes.
    pub fn save(bytes: &'a mut Vec<u8>) -> Self {
        Self(Mode::Save(bytes))
    }

    /// A checkpoint that reads these bytes.
    pub fn restore(bytes: &'a [u8]) -> Self {
        Self(Mode::Restore(bytes))
    }

    /// Whether values are read.
    pub fn is_restoring(&self) -> bool {
        matches!(self.0, Mode::Restore(_))
    }

    /// Appends these bytes and returns them, or reads and returns as many.
    pub(super) fn bytes<const N: usize>(&mut self, value: [u8; N]) -> Result<[u8; N], CheckpointError> {
        match &mut self.0 {
            Mode::Save(bytes) => {
                bytes.try_reserve(N).map_err(|_| CheckpointError::OutOfMemory)?;
                bytes.extend_from_slice(&value);
                Ok(value)
            }
            Mode::Restore(bytes) => {
                let (value, rest) = bytes.split_first_chunk().ok_or(CheckpointError::Truncated)?;
                *bytes = rest;
                Ok(*value)
            }
        }
    }

    /// An index or a count. A value that is read must be less than `below`.
    ///
    /// # Errors
    /// [`CheckpointError::Invalid`] with `what`, or as for any value.
    pub fn index(&mut self, value: &mut usize, below: usize, what: &'static str) -> Result<(), CheckpointError> {
        let number = u64::from_le_bytes(self.bytes((*value as u64).to_le_bytes())?);
        let index = usize::try_from(number).unwrap_or(usize::MAX);
        self.check(index < below, what)?;
        *value = index;
        Ok(())
    }

    /// An index or a count of 32 bits. A value that is read must be less than `below`.
    ///
    /// # Errors
    /// As for `index`.
    pub fn index_u32(&mut self, value: &mut u32, below: usize, what: &'static str) -> Result<(), CheckpointError> {
        let number = u32::from_le_bytes(self.bytes(value.to_le_bytes())?);
        self.check((number as usize) < below, what)?;
        *value = number;
        Ok(())
    }

    /// Values whose number may change, with their number before them.
    ///
    /// # Errors
    /// As for any value; `Invalid` for more values than there are bytes.
    pub fn values<T: Persist + Default + Clone>(&mut self, values: &mut Vec<T>) -> Result<(), CheckpointError> {
        let mut count = values.len();
        let left = if let Mode::Restore(bytes) = &self.0 { bytes.len() } else { usize::MAX };
        self.index(&mut count, left, "number of values")?;
        if count > values.len() {
            values.try_reserve(count - values.len()).map_err(|_| CheckpointError::OutOfMemory)?;
        }
        values.resize(count, T::default());
        values.persist(self)
    }

    /// Rejects restored values that are not valid; `what` names them. While saving, it rejects nothing: only a lack of
    /// memory may prevent a run from being saved.
    ///
    /// # Errors
    /// [`CheckpointError::Invalid`] with `what`.
    pub fn check(&self, is_valid: bool, what: &'static str) -> Result<(), CheckpointError> {
        if is_valid || !self.is_restoring() { Ok(()) } else { Err(CheckpointError::Invalid(what)) }
    }

    /// Ends the checkpoint.
    ///
    /// # Errors
    /// [`CheckpointError::TrailingBytes`] if not all bytes were read.
    pub fn finish(self) -> Result<(), CheckpointError> {
        match self.0 {
            Mode::Restore([_, ..]) => Err(CheckpointError::TrailingBytes),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_saved_is_restored() {
        let mut bytes = Vec::new();
        let mut saved = (7_u32, -0.0_f64, Some(3_u32), [true, false], i64::MIN);
        saved.persist(&mut Checkpoint::save(&mut bytes)).expect("memory suffices");
        let mut restored = (0, 0.0, None, [false; 2], 0);
        let mut checkpoint = Checkpoint::restore(&bytes);
        restored.persist(&mut checkpoint).expect("the bytes are complete");
        checkpoint.finish().expect("all bytes were read");
        assert_eq!(restored, saved);
        assert!(restored.1.is_sign_negative());
    }

    #[test]
    fn nothing_that_is_saved_is_refused() {
        let (mut bytes, mut index, mut index_32) = (Vec::new(), 9, 9);
        let mut checkpoint = Checkpoint::save(&mut bytes);
        assert_eq!(checkpoint.index(&mut index, 4, "row"), Ok(()));
        assert_eq!(checkpoint.index_u32(&mut index_32, 4, "row"), Ok(()));
        assert_eq!(checkpoint.check(false, "row"), Ok(()));
    }

    #[test]
    fn damaged_bytes_are_refused() {
        let mut index = 3;
        let bytes = 3_u64.to_le_bytes();
        let index_of = |bytes, index: &mut usize, below| Checkpoint::restore(bytes).index(index, below, "row");
        assert_eq!(index_of(&bytes, &mut index, 4), Ok(()));
        assert_eq!(index_of(&bytes, &mut index, 3), Err(CheckpointError::Invalid("row")));
        assert_eq!(index_of(&bytes[..7], &mut index, 4), Err(CheckpointError::Truncated));
        assert_eq!(Checkpoint::restore(&bytes).finish(), Err(CheckpointError::TrailingBytes));
        let not_a_bool = [2_u8];
        assert_eq!(true.persist(&mut Checkpoint::restore(&not_a_bool)), Err(CheckpointError::Invalid("boolean")));
    }
}
