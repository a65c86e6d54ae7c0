//! Features map an observation to the active rows of a Q table.

mod any_grid;
mod bins;
mod checked_tilings;
#[expect(clippy::module_inception, reason = "each trait is in the file named for it")]
mod features;
mod fixed_tile_coding;
mod hashing;
mod identity;
mod lane_rows;
mod multi_discrete_index;
mod product;
mod rounding;
mod tile_coding;

pub use any_grid::AnyGrid;
pub use bins::{Bins, Edges};
pub use features::{ActiveRows, BatchFeatures, Features, OutOfBounds, persist_rows};
pub use fixed_tile_coding::{FixedTileCoding, FixedTiles};
pub use identity::Identity;
pub use lane_rows::LaneRows;
pub use multi_discrete_index::MultiDiscreteIndex;
pub use product::{Factor, FactorFeatures, Product};
pub use rounding::{Axis, Rounding};
pub use tile_coding::{ActiveTiles, MAX_TILINGS, TileCoding};
