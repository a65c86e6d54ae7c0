//! Flags of a few sub-environments, which are combined in one operation.

/// The number of sub-environments that are searched together for ended episodes.
pub(super) const CHUNK: usize = 8;

/// One flag for each sub-environment of a chunk: a byte of value 0 or 1.
pub(super) type Flags = u64;

/// The flags of a chunk. The last chunk may be shorter.
#[inline]
pub(super) fn read(flags: &[bool]) -> Flags {
    let mut chunk = [false; CHUNK];
    if let Some(whole) = flags.first_chunk() {
        chunk = *whole;
    } else {
        chunk.iter_mut().zip(flags).for_each(|(to, &flag)| *to = flag);
    }
    u64::from_le_bytes(chunk.map(u8::from))
}

/// Replaces the flags of a chunk.
#[inline]
pub(super) fn write(new: Flags, flags: &mut [bool]) {
    let chunk = new.to_le_bytes().map(|byte| byte != 0);
    if let Some(whole) = flags.first_chunk_mut() {
        *whole = chunk;
    } else {
        flags.iter_mut().zip(chunk).for_each(|(flag, new)| *flag = new);
    }
}

/// The lanes whose flags are set. A branch for each lane would be unpredictable.
#[inline]
pub(super) fn lanes(mut flags: Flags) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        if flags == 0 {
            return None;
        }
        let lane = flags.trailing_zeros() / u8::BITS;
        flags &= flags - 1;
        Some(lane as usize)
    })
}
