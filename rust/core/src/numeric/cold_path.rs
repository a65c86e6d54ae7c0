//! A hint for the compiler about rare branches.

/// Marks the branch that calls it as rare, so that the compiler keeps it a branch. The processor then predicts it,
/// whereas a conditional move would make every step wait for the comparison. To be replaced by `std::hint::cold_path`
/// once the minimum supported Rust version has it.
#[cold]
pub(crate) fn cold_path() {}
