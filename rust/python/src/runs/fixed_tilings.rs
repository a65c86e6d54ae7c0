//! Tile coding that is compiled for the usual numbers of tilings.

use pyo3::prelude::*;
use qtab_core::features::FixedTileCoding;

use crate::error::invalid;
use crate::spec::TilesSpec;

/// Evaluates an expression in which the constant `$n` is the number of tilings, or another one if the number is unusual. A
/// usual one is a power of two that is at least four times the number of components (Sutton & Barto, section 9.5.4).
macro_rules! match_tilings {
    ($tilings:expr, $n:ident => $compiled:expr, _ => $other:expr $(,)?) => {
        match $tilings {
            8 => {
                const $n: usize = 8;
                $compiled
            }
            16 => {
                const $n: usize = 16;
                $compiled
            }
            32 => {
                const $n: usize = 32;
                $compiled
            }
            _ => $other,
        }
    };
}

pub(super) use match_tilings;

/// Exactly `N` tilings of `M` components.
pub(super) fn fixed_tiles<const M: usize, const N: usize>(tiles: &TilesSpec) -> PyResult<FixedTileCoding<f32, M, N>> {
    FixedTileCoding::new(&tiles.tile_coding())
        .ok_or_else(|| invalid("discretizer", format!("{N} tilings of {M} components"), "others"))
}
