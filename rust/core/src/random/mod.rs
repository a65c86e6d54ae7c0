//! `NumPy`'s random generators: the same seed gives the same numbers, bit for bit.

mod agent_rng;
mod mt19937;
mod pcg64;
mod pcg64_lanes;
mod rand_traits;
mod rng;
mod seed_sequence;
mod standard_normal;

pub use agent_rng::AgentRng;
pub use mt19937::Mt19937;
pub use pcg64::Pcg64;
pub(crate) use pcg64_lanes::{Pcg64Lanes, explore_from};
pub use rand_traits::{AsRand, FromRand};
pub(crate) use rng::TWO_POW_53;
pub use rng::{NoRng, Rng};
pub use seed_sequence::SeedSequence;
