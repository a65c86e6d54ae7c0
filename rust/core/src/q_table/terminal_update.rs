//! The update at a terminal state.

/// The update at a terminal state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TerminalUpdate {
    /// Q ← R, the article's rule. It is right only if the last reward is always the same.
    Assign,
    /// Q ← Q + α (R - Q): the value of a terminal state is zero (Sutton & Barto, section 6.1).
    Target,
}
