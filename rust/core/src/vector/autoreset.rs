//! What happens when an episode ends.

/// What becomes of a sub-environment whose episode is over: Gymnasium's `AutoresetMode`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Autoreset {
    /// Its next step is a reset, whatever its action.
    NextStep,
    /// It is reset at once; what it showed last is among the [`VectorEnv::finals`].
    SameStep,
    /// Nothing: it must be reset before it is stepped again.
    Disabled,
}
