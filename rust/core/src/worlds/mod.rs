//! The worlds that need no Python, and what wraps any world.

mod boxed;
mod native;
mod recorded;

pub use boxed::Boxed;
pub use native::{Native, Position};
pub use recorded::{Recorded, Recording, Recordings, Start};
