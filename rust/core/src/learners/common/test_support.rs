//! An agent with round numbers, for updates computed by hand.

use super::Agent;
use crate::features::FeatureVector;
use crate::policies::{AnyPolicy, TieBreaking};
use crate::q_table::{QTable, TerminalUpdate};
use crate::random::{Pcg64, SeedSequence};
use crate::schedules::{LearningRate, Schedule};

/// An agent with two actions, α = γ = 1/2 and ε = 0.
pub(crate) fn agent(values: &[f64]) -> Agent {
    Agent {
        table: QTable::new(values.to_vec(), 2),
        policy: AnyPolicy::EpsilonGreedy { epsilon: Schedule::constant(0.0), ties: TieBreaking::First },
        learning_rate: LearningRate::scheduled(Schedule::constant(0.5), 1),
        discount: 0.5,
        terminal_update: TerminalUpdate::Target,
        masks: None,
    }
}

/// Two weighted features.
pub(crate) fn features() -> FeatureVector<2> {
    FeatureVector::new(&[1.0, 0.5]).expect("there is room")
}

/// The generator of seed 0.
pub(crate) fn rng() -> Pcg64 {
    Pcg64::new(&SeedSequence::new(&[0]))
}
