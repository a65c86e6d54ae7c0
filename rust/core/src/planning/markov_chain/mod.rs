//! The Markov chain of a policy, and its linear equations.

mod chain;
mod elimination;
mod equations;

pub(super) use chain::MarkovChain;
pub(super) use equations::Equations;
