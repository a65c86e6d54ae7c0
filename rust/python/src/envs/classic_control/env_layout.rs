//! How Gymnasium's class of an environment keeps what it keeps.

/// The attributes of a Gymnasium class, besides its parameters.
pub(crate) struct EnvLayout {
    /// How many numbers the state has.
    pub(crate) state_len: usize,
    /// Whether a step leaves the state as a tuple, not as an array.
    pub(crate) state_is_tuple: bool,
    /// How many actions `step` accepts, where it asks the action space.
    pub(crate) num_actions: Option<usize>,
    /// Whether `step` calls `np.sin` or `np.cos`.
    pub(crate) calls_numpy_trigonometry: bool,
    /// The attribute that is None during an episode, and 0 once it reached a terminal state.
    pub(crate) terminal_counter: Option<&'static str>,
    /// The attribute that is None after a reset, and holds the last action after a step.
    pub(crate) last_action: Option<&'static str>,
}

impl EnvLayout {
    /// A state of so many numbers, kept in an array, and no attributes besides.
    pub(super) const fn new(state_len: usize) -> Self {
        Self {
            state_len,
            state_is_tuple: false,
            num_actions: None,
            calls_numpy_trigonometry: false,
            terminal_counter: None,
            last_action: None,
        }
    }
}
