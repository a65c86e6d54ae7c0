//! Observations of which some components are indices and others are discretized.

use super::{ActiveTiles, AnyGrid, Features, MAX_TILINGS, OutOfBounds, TileCoding};

/// The features of a factor of a [`Product`].
#[derive(Clone, Debug, PartialEq)]
pub enum FactorFeatures {
    /// One component: an index below this number.
    Index(u32),
    /// One component on a grid with arithmetic in f32.
    Single(AnyGrid<f32>),
    /// One component on a grid with arithmetic in f64.
    Double(AnyGrid<f64>),
    /// Any number of components, with tile coding.
    TileCoding(TileCoding<f64>),
}

impl FactorFeatures {
    fn len(&self) -> usize {
        match self {
            Self::Index(count) => *count as usize,
            Self::Single(grid) => Features::<[f32]>::len(grid),
            Self::Double(grid) => Features::<[f64]>::len(grid),
            Self::TileCoding(tiles) => Features::<[f64]>::len(tiles),
        }
    }
}

/// Some components of an observation, with their features and their stride in the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Factor {
    /// The components, by their index in the observation: one, except for tiles.
    pub components: Vec<usize>,
    /// The features that map them to rows.
    pub features: FactorFeatures,
    /// The distance in the table between two neighbouring rows of the factor.
    pub stride: u32,
}

/// A table with a row for each combination of the rows of its factors.
#[derive(Clone, Debug, PartialEq)]
pub struct Product {
    factors: Vec<Factor>,
    n_rows: usize,
}

impl Product {
    /// The table of these factors; `None` if a row would exceed the number of combinations, or if more than one factor
    /// is a tile coding.
    pub fn new(factors: Vec<Factor>) -> Option<Self> {
        let mut n_rows = 1_usize;
        let mut last = 0_usize;
        for factor in &factors {
            let rows = factor.features.len();
            n_rows = n_rows.checked_mul(rows)?;
            last = rows.checked_sub(1)?.checked_mul(factor.stride as usize)?.checked_add(last)?;
            let is_tiles = matches!(factor.features, FactorFeatures::TileCoding(_));
            if factor.components.is_empty() || (factor.components.len() > 1 && !is_tiles) {
                return None;
            }
        }
        let tile_codings =
            factors.iter().filter(|factor| matches!(factor.features, FactorFeatures::TileCoding(_))).count();
        (tile_codings <= 1 && last < n_rows && u32::try_from(n_rows).is_ok()).then_some(Self { factors, n_rows })
    }
}

impl Features<[f64]> for Product {
    type Active = ActiveTiles;

    fn active_rows(&self, observation: &[f64]) -> Result<ActiveTiles, OutOfBounds> {
        let mut rows = [0; MAX_TILINGS];
        let mut n_active = 1;
        let mut row = 0;
        for Factor { components, features, stride } in &self.factors {
            let axis = components[0];
            let value = observation[axis];
            let within = |error: OutOfBounds| OutOfBounds { axis: components[error.axis], value: error.value };
            row += stride
                * match features {
                    FactorFeatures::Index(count) => {
                        let index = value as u32;
                        if f64::from(index) != value || index >= *count {
                            return Err(OutOfBounds { axis, value });
                        }
                        index
                    }
                    FactorFeatures::Single(grid) => grid.active_rows(&[value as f32]).map_err(within)?[0],
                    FactorFeatures::Double(grid) => grid.active_rows(&[value]).map_err(within)?[0],
                    FactorFeatures::TileCoding(tiles) => {
                        let values: Vec<f64> = components.iter().map(|&axis| observation[axis]).collect();
                        let active = tiles.active_rows(&values).map_err(within)?;
                        n_active = active.as_ref().len();
                        for (row, tile) in rows.iter_mut().zip(active.as_ref()) {
                            *row = tile * stride;
                        }
                        0
                    }
                };
        }
        let active = &mut rows[..n_active];
        for tile in active.iter_mut() {
            *tile += row;
        }
        match ActiveTiles::try_from(&*active) {
            Ok(active) => Ok(active),
            Err(()) => unreachable!("there is room for every tiling"),
        }
    }

    fn len(&self) -> usize {
        self.n_rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::features::{Bins, Edges};

    fn index(component: usize, count: u32, stride: u32) -> Factor {
        Factor { components: vec![component], features: FactorFeatures::Index(count), stride }
    }

    #[test]
    fn cells_of_mixed_components_are_in_c_order() {
        let bins = AnyGrid::Bins(Bins::new(vec![Edges::equal_width(0.0_f64, 1.0, 4)]));
        let bins = Factor { components: vec![1], features: FactorFeatures::Double(bins), stride: 2 };
        let Some(product) = Product::new(vec![index(0, 3, 8), bins, index(2, 2, 1)]) else {
            unreachable!("the factors fill the table")
        };
        assert_eq!(Features::<[f64]>::len(&product), 24);
        assert_eq!(product.active_rows(&[2.0, 0.6, 1.0]).map(|active| active.as_ref().to_vec()), Ok(vec![21]));
        assert_eq!(product.active_rows(&[2.0, 0.6, 2.0]), Err(OutOfBounds { axis: 2, value: 2.0 }));
        assert!(product.active_rows(&[0.5, 0.6, 1.0]).is_err());
        assert!(product.active_rows(&[-1.0, 0.6, 1.0]).is_err());
        assert!(product.active_rows(&[f64::NAN, 0.6, 1.0]).is_err());
    }

    #[test]
    fn each_index_has_tilings_of_its_own() {
        let tiles = TileCoding::new(&[0.0], &[1.0], &[4], 2);
        let tiles = Factor { components: vec![0], features: FactorFeatures::TileCoding(tiles), stride: 1 };
        let Some(product) = Product::new(vec![tiles, index(1, 3, 10)]) else {
            unreachable!("the factors fill the table")
        };
        assert_eq!(Features::<[f64]>::len(&product), 30);
        assert_eq!(product.active_rows(&[0.0, 2.0]).map(|active| active.as_ref().to_vec()), Ok(vec![20, 25]));
    }

    #[test]
    fn a_row_outside_the_table_is_refused() {
        assert_eq!(Product::new(vec![index(0, 3, 2)]), None);
        assert_eq!(Product::new(vec![index(0, 0, 1)]), None);
        assert_eq!(Product::new(vec![index(0, u32::MAX, 1), index(1, u32::MAX, u32::MAX)]), None);
    }
}
