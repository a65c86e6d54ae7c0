//! Choices without a branch, in lanes and in plain code alike.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

/// All bits if `condition` holds, otherwise none.
#[inline(always)]
pub(crate) fn mask(condition: bool) -> u64 {
    if condition { u64::MAX } else { 0 }
}

/// `yes` where a mask has all bits, `no` where it has none.
#[inline(always)]
pub(crate) fn select(mask: u64, yes: u64, no: u64) -> u64 {
    (yes & mask) | (no & !mask)
}
