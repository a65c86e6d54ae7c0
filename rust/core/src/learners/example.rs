//! Small numbers that updates are worked out by hand with.

use super::{Agent, Behaviour, Rate, Schedule, TerminalUpdate, Ties};
use crate::random::{Pcg64, SeedSequence};
use crate::table::Table;

/// Two actions, α = γ = 1/2, always greedy.
pub(crate) fn agent(values: &[f64]) -> Agent {
    Agent {
        table: Table::new(values.to_vec(), 2),
        policy: Behaviour::EpsilonGreedy { epsilon: Schedule::constant(0.0), ties: Ties::First },
        learning_rate: Rate::scheduled(Schedule::constant(0.5), 1),
        discount: 0.5,
        terminal_update: TerminalUpdate::Target,
    }
}

pub(crate) fn draw() -> Pcg64 {
    Pcg64::new(&SeedSequence::new(&[0]))
}
