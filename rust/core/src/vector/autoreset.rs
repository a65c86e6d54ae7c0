//! What happens when an episode ends.

/// What happens to a sub-environment when its episode ends: Gymnasium's `AutoresetMode`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Autoreset {
    /// The next step resets it and ignores its action.
    NextStep,
    /// The same step resets it. Its last state is in [`VectorEnv::final_states`](super::VectorEnv::final_states).
    SameStep,
    /// Nothing. The caller must reset it before the next step.
    Disabled,
}
