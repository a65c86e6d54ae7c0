//! What a task passes on whose policy reads the observations: the active rows, and the action that the policy chose.

/// An action, and how much more likely the target policy takes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// The action.
    pub action: u32,
    /// π(A|S) / b(A|S): 1 where the policy that acts is the one that is evaluated.
    pub ratio: f64,
}

impl Choice {
    /// Where no action is taken: the episode is over.
    pub const NONE: Self = Self { action: 0, ratio: 1.0 };
}

/// The active rows of an observation, with the action that the policy chose by reading it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observed<R> {
    /// The active rows.
    pub active: R,
    /// What the policy chose.
    pub choice: Choice,
}

impl<R: AsRef<[u32]>> AsRef<[u32]> for Observed<R> {
    #[inline]
    fn as_ref(&self) -> &[u32] {
        self.active.as_ref()
    }
}

impl<'a, R: TryFrom<&'a [u32]>> TryFrom<&'a [u32]> for Observed<R> {
    type Error = R::Error;

    /// The rows, without an action.
    fn try_from(active: &'a [u32]) -> Result<Self, R::Error> {
        Ok(Self { active: active.try_into()?, choice: Choice::NONE })
    }
}
