//! Features map an observation to the active rows of a Q table.

mod active_features;
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
mod weighted;

pub use active_features::ActiveFeatures;
pub(crate) use active_features::assert_binary;
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
pub use weighted::{AnyBasis, CoarseCoding, FeatureVector, FourierBasis, MAX_FEATURES, PolynomialBasis, RadialBasis};
