//! Flags of a few sub-environments, which are combined in one operation.

use std::ops::{BitAnd, BitOr, Not};

/// The number of sub-environments that are searched together for ended episodes.
pub(super) const CHUNK: usize = 8;

/// One flag for each sub-environment of a chunk: a byte of value 0 or 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Flags(u64);

impl Flags {
    pub(super) const NONE: Self = Self(0);

    /// The flags of a chunk. The last chunk may be shorter.
    #[inline]
    pub(super) fn read(flags: &[bool]) -> Self {
        let mut chunk = [false; CHUNK];
        if let Some(whole) = flags.first_chunk() {
            chunk = *whole;
        } else {
            chunk.iter_mut().zip(flags).for_each(|(to, &flag)| *to = flag);
        }
        Self(u64::from_le_bytes(chunk.map(u8::from)))
    }

    /// Replaces the flags of a chunk.
    #[inline]
    pub(super) fn write(self, flags: &mut [bool]) {
        let chunk = self.0.to_le_bytes().map(|byte| byte != 0);
        if let Some(whole) = flags.first_chunk_mut() {
            *whole = chunk;
        } else {
            flags.iter_mut().zip(chunk).for_each(|(flag, new)| *flag = new);
        }
    }

    /// The lanes whose flags are set. A branch for each lane would be unpredictable.
    #[inline]
    pub(super) fn lanes(self) -> impl Iterator<Item = usize> {
        let mut bytes = self.0;
        std::iter::from_fn(move || {
            if bytes == 0 {
                return None;
            }
            let lane = bytes.trailing_zeros() / u8::BITS;
            bytes &= bytes - 1;
            Some(lane as usize)
        })
    }
}

impl BitAnd for Flags {
    type Output = Self;

    #[inline]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl BitOr for Flags {
    type Output = Self;

    #[inline]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl Not for Flags {
    type Output = Self;

    #[inline]
    fn not(self) -> Self {
        Self(self.0 ^ u64::from_le_bytes([1; CHUNK]))
    }
}
