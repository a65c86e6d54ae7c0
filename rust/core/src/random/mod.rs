//! `NumPy`'s random streams: the same seed gives the same draws, bit for bit.

mod draw;
mod mt19937;
mod pcg64;
mod seed_sequence;
mod stream;

pub(crate) use draw::FLOATS;
pub use draw::{Draw, NoDraw};
pub use mt19937::Mt19937;
pub use pcg64::Pcg64;
pub(crate) use pcg64::{bounded, unit};
pub use seed_sequence::SeedSequence;
pub use stream::Stream;
