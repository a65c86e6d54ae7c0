//! Memory that a function in C writes.

#![expect(unsafe_code, reason = "functions in C receive the addresses of buffers")]

use std::collections::TryReserveError;
use std::ffi::c_void;
use std::slice;

use crate::Number;
use crate::table::ALIGNMENT;

/// The number of blocks after a buffer that no function may write.
const GUARD_BLOCKS: usize = 4;

/// The bytes of a block after a buffer.
const GUARD: Block = Block([0xA5; ALIGNMENT]);

/// Some bytes with the alignment of a state.
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Block([u8; ALIGNMENT]);

/// An aligned buffer, which is followed by guard bytes, so that a function that writes a little too much does no harm
/// and can be told.
#[derive(Debug)]
pub(super) struct Buffer {
    blocks: Box<[Block]>,
    /// The number of bytes before the guard bytes of the last used block.
    size: usize,
}

impl Buffer {
    /// A buffer of `size` bytes, all 0.
    pub(super) fn new(size: usize) -> Result<Self, TryReserveError> {
        let used = size.div_ceil(ALIGNMENT);
        let mut blocks = Vec::new();
        blocks.try_reserve_exact(used + GUARD_BLOCKS)?;
        blocks.resize(used + GUARD_BLOCKS, GUARD);
        let mut buffer = Self { blocks: blocks.into_boxed_slice(), size };
        buffer.bytes_mut().fill(0);
        Ok(buffer)
    }

    /// The address of the first byte.
    #[inline]
    pub(super) fn address(&mut self) -> *mut c_void {
        self.blocks.as_mut_ptr().cast()
    }

    pub(super) fn bytes(&self) -> &[u8] {
        // SAFETY: the blocks have at least this many bytes, all of them initialized.
        unsafe { slice::from_raw_parts(self.blocks.as_ptr().cast(), self.size) }
    }

    pub(super) fn bytes_mut(&mut self) -> &mut [u8] {
        // SAFETY: as in `bytes`.
        unsafe { slice::from_raw_parts_mut(self.blocks.as_mut_ptr().cast(), self.size) }
    }

    /// The bytes as numbers.
    #[inline]
    pub(super) fn numbers<T: Number>(&self) -> &[T] {
        // SAFETY: the blocks are aligned for every `Number`, of which every bit pattern is valid, and have as many bytes.
        unsafe { slice::from_raw_parts(self.blocks.as_ptr().cast(), self.size / size_of::<T>()) }
    }

    /// Whether the guard bytes are unchanged.
    pub(super) fn is_intact(&self) -> bool {
        let mut bytes = self.blocks.iter().flat_map(|block| block.0).skip(self.size);
        bytes.all(|byte| byte == GUARD.0[0])
    }
}
