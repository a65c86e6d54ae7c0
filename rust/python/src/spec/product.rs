//! A discretizer with a separate discretizer for each group of components.

use pyo3::prelude::*;
use qtab_core::Features;
use qtab_core::features::{Factor, FactorFeatures, Product};

use super::discretizer::{DiscretizerSpec, FloatType};
use super::fields::Fields;
use crate::error::invalid;

/// Factors, each of which discretizes some of the components.
#[derive(Clone, Debug)]
pub(crate) struct ProductSpec {
    pub(crate) features: Product,
    /// The number of components of an observation.
    pub(crate) dimensions: usize,
    /// The number of rows that are active at a time.
    pub(crate) tilings: u32,
    pub(crate) has_tiles: bool,
}

impl ProductSpec {
    pub(super) fn parse(fields: &Fields<'_>) -> PyResult<Self> {
        let dimensions: usize = fields.get("dimensions")?;
        let mut factors = Vec::new();
        let (mut tilings, mut has_tiles) = (1, false);
        let given: Vec<Bound<'_, PyAny>> = fields.get("factors")?;
        for given in &given {
            let given = Fields::new(given)?;
            let discretizer = DiscretizerSpec::parse(&given.nested("discretizer")?)?;
            if let DiscretizerSpec::Tiles(tiles) = &discretizer {
                (tilings, has_tiles) = (tiles.tilings, true);
            }
            let components: Vec<usize> = given.get("components")?;
            let (features, components_of_features) = features(&discretizer)?;
            if components.len() != components_of_features || components.iter().any(|&index| index >= dimensions) {
                let wanted = format!("{components_of_features} of {dimensions} components");
                return Err(invalid(&given.path("components"), wanted, format!("{components:?}")));
            }
            factors.push(Factor { components, features, stride: given.get("stride")? });
        }
        let product = Product::new(factors)
            .ok_or_else(|| invalid(&fields.path("factors"), "factors whose rows fit into a table", given.len()))?;
        Ok(Self { features: product, dimensions, tilings, has_tiles })
    }

    pub(crate) fn n_rows(&self) -> usize {
        self.features.len()
    }
}

/// The features of a factor, and the number of components they take.
fn features(discretizer: &DiscretizerSpec) -> PyResult<(FactorFeatures, usize)> {
    let features = match discretizer {
        DiscretizerSpec::Identity(reader) => {
            let counts: Vec<u32> = reader.counts().collect();
            return match counts[..] {
                [count] => Ok((FactorFeatures::Index(count), 1)),
                _ => Err(invalid("discretizer", "one of a single component", counts.len())),
            };
        }
        DiscretizerSpec::Tiles(tiles) => FactorFeatures::TileCoding(tiles.tile_coding()),
        grid => match grid.box_space()?.0 {
            FloatType::F32 => FactorFeatures::Single(grid.grid(|bound| bound as f32)?),
            FloatType::F64 => FactorFeatures::Double(grid.grid(|bound| bound)?),
        },
    };
    Ok((features, discretizer.box_space()?.1))
}
