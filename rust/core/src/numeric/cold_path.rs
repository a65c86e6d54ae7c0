//! What the compiler cannot know about how often something happens.

/// Called in a branch that is seldom taken, it keeps the branch a branch: the processor predicts it and goes on, where a
/// select would make every step wait for the comparison. (`std::hint::cold_path`, once the oldest supported Rust has it.)
#[cold]
pub(crate) fn cold_path() {}
