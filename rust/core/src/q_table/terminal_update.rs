//! The update at the end of an episode.

/// What an update does at a terminal state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TerminalUpdate {
    /// Q ← R, the article's rule: right where the last reward is always the same.
    Assign,
    /// Q ← Q + α (R - Q), the book's: the value of a terminal state is zero.
    Target,
}
