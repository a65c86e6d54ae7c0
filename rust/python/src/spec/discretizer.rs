//! The spec of a discretizer, and the core's features built from it.

use pyo3::prelude::*;
use qtab_core::features::{AnyGrid, Axis, Bins, Edges, MAX_TILINGS, Rounding, TileCoding};
use qtab_core::numeric::Float;
use qtab_core::settings::SettingSource;

use super::fields::{Fields, Variant};
use super::product::ProductSpec;
use super::weighted::WeightedSpec;
use crate::convert::DiscreteReader;
use crate::error::invalid;

#[derive(Clone, Debug)]
pub(crate) enum DiscretizerSpec {
    Round(RoundSpec),
    Bins(BinsSpec),
    Tiles(TilesSpec),
    Weighted(WeightedSpec),
    Identity(DiscreteReader),
    Product(ProductSpec),
}

/// The dtype of a Box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FloatType {
    F32,
    F64,
}

/// A grid of cells to which observations are rounded.
#[derive(Clone, Debug)]
pub(crate) struct RoundSpec {
    dtype: FloatType,
    low: Vec<f64>,
    high: Vec<f64>,
    scale: Vec<f64>,
}

/// A grid of bins between edges.
#[derive(Clone, Debug)]
pub(crate) struct BinsSpec {
    dtype: FloatType,
    edges: Vec<Edges>,
}

/// Tile coding.
#[derive(Clone, Debug)]
pub(crate) struct TilesSpec {
    dtype: FloatType,
    low: Vec<f64>,
    high: Vec<f64>,
    tiles: Vec<u32>,
    pub(crate) tilings: u32,
    hashed_rows: Option<u32>,
}

/// Every discretizer by its name. `qtab.config` also has `edges`, which is sent as `bins`; a test compares the lists.
pub(crate) const DISCRETIZERS: &[Variant<DiscretizerSpec>] = &[
    ("round", |fields| RoundSpec::parse(fields).map(DiscretizerSpec::Round)),
    ("bins", |fields| BinsSpec::parse(fields).map(DiscretizerSpec::Bins)),
    ("tiles", |fields| TilesSpec::parse(fields).map(DiscretizerSpec::Tiles)),
    ("fourier", |fields| WeightedSpec::fourier(fields).map(DiscretizerSpec::Weighted)),
    ("polynomial", |fields| WeightedSpec::polynomial(fields).map(DiscretizerSpec::Weighted)),
    ("radial", |fields| WeightedSpec::radial(fields).map(DiscretizerSpec::Weighted)),
    ("coarse", |fields| WeightedSpec::coarse(fields).map(DiscretizerSpec::Weighted)),
    ("identity", identity),
    ("product", |fields| ProductSpec::parse(fields).map(DiscretizerSpec::Product)),
];

impl DiscretizerSpec {
    pub(crate) fn parse(fields: &Fields<'_>) -> PyResult<Self> {
        let spec: Self = fields.tagged(DISCRETIZERS)?;
        let rows = spec.row_counts().into_iter().try_fold(1_u64, u64::checked_mul);
        if rows.is_none_or(|rows| rows == 0 || rows > u64::from(u32::MAX)) {
            let got = rows.map_or_else(|| "more".into(), |rows| rows.to_string());
            return Err(invalid(fields.name(), "one of 1 to 2**32 - 1 rows", got));
        }
        Ok(spec)
    }

    /// The numbers whose product is the number of rows.
    fn row_counts(&self) -> Vec<u64> {
        match self {
            Self::Round(round) if round.dtype == FloatType::F32 => sizes(&round.axes(|bound| bound as f32)),
            Self::Round(round) => sizes(&round.axes(|bound| bound)),
            Self::Bins(bins) => bins.edges.iter().map(|edges| edges.bins() as u64).collect(),
            Self::Tiles(TilesSpec { hashed_rows: Some(rows), .. }) => vec![u64::from(*rows)],
            Self::Tiles(tiles) => {
                let tiles_of_axes = tiles.tiles.iter().map(|&count| u64::from(count) + 1);
                [u64::from(tiles.tilings)].into_iter().chain(tiles_of_axes).collect()
            }
            Self::Weighted(features) => vec![features.n_features() as u64],
            Self::Identity(reader) => reader.counts().map(u64::from).collect(),
            Self::Product(product) => vec![product.n_rows() as u64],
        }
    }

    /// The number of rows. Parsing has checked that it fits.
    pub(crate) fn num_rows(&self) -> usize {
        self.row_counts().into_iter().product::<u64>() as usize
    }

    /// The dtype and the number of components of the observations. Returns an error for integer observations.
    pub(crate) fn box_space(&self) -> PyResult<(FloatType, usize)> {
        match self {
            Self::Round(round) => Ok((round.dtype, round.scale.len())),
            Self::Bins(bins) => Ok((bins.dtype, bins.edges.len())),
            Self::Tiles(tiles) => Ok((tiles.dtype, tiles.tiles.len())),
            Self::Weighted(features) => Ok((features.dtype, features.dimensions())),
            Self::Product(product) => Ok((FloatType::F64, product.dimensions)),
            Self::Identity(_) => Err(invalid("discretizer", "one for a Box of observations", "'identity'")),
        }
    }

    /// Checks that the observations are integers, with this many rows in the table.
    pub(crate) fn check_identity(&self, n_rows: usize) -> PyResult<()> {
        match self {
            Self::Identity(reader) if reader.n_rows() == n_rows => Ok(()),
            Self::Identity(reader) => Err(invalid("discretizer", format!("one of {n_rows} rows"), reader.n_rows())),
            _ => Err(invalid("discretizer", "'identity' for this environment", "one for a Box of observations")),
        }
    }

    /// The number of rows that are active at a time.
    pub(crate) fn n_active(&self) -> usize {
        match self {
            Self::Tiles(tiles) => tiles.tilings as usize,
            Self::Weighted(features) => features.n_features(),
            Self::Product(product) => product.tilings as usize,
            _ => 1,
        }
    }

    /// The features, if they are weighted: each row has a number for an observation.
    pub(crate) fn weighted(&self) -> Option<&WeightedSpec> {
        match self {
            Self::Weighted(features) => Some(features),
            Self::Round(_) | Self::Bins(_) | Self::Tiles(_) | Self::Identity(_) | Self::Product(_) => None,
        }
    }

    /// Whether the rows are those of tilings, so that no state has a row of its own.
    pub(crate) fn is_tile_coding(&self) -> bool {
        match self {
            Self::Tiles(_) => true,
            Self::Product(product) => product.has_tiles,
            _ => false,
        }
    }

    /// The grid, with arithmetic in `T`. Returns an error for discretizers that are not a grid of a Box.
    pub(crate) fn grid<T: Float>(&self, to_dtype: impl Fn(f64) -> T) -> PyResult<AnyGrid<T>> {
        match self {
            Self::Round(round) => Ok(AnyGrid::Rounding(Rounding::new(round.axes(to_dtype)))),
            Self::Bins(bins) => Ok(AnyGrid::Bins(Bins::new(bins.edges.clone()))),
            Self::Tiles(_) => Err(invalid("discretizer", "'round' or 'bins'", "'tiles'")),
            Self::Weighted(_) => Err(invalid("discretizer", "'round', 'bins' or 'tiles'", "weighted features")),
            Self::Identity(_) => Err(invalid("discretizer", "'round' or 'bins'", "'identity'")),
            Self::Product(_) => Err(invalid("discretizer", "'round' or 'bins'", "'product'")),
        }
    }
}

fn sizes<T: Float>(axes: &[Axis<T>]) -> Vec<u64> {
    axes.iter().map(|axis| axis.size() as u64).collect()
}

fn identity(fields: &Fields<'_>) -> PyResult<DiscretizerSpec> {
    let (first, counts): (Vec<i64>, Vec<u32>) = (fields.get("first")?, fields.get("counts")?);
    same_length(fields, "counts", counts.len(), first.len())?;
    let reader = DiscreteReader::new(first.into_iter().zip(counts).collect(), fields.get("scalar")?);
    if reader.is_scalar() {
        same_length(fields, "first", reader.dimensions(), 1)?;
    }
    Ok(DiscretizerSpec::Identity(reader))
}

impl FloatType {
    pub(super) fn parse(fields: &Fields<'_>) -> PyResult<Self> {
        fields.word("dtype", &[("float32", Self::F32), ("float64", Self::F64)])
    }
}

impl RoundSpec {
    fn parse(fields: &Fields<'_>) -> PyResult<Self> {
        let (low, high): (Vec<f64>, Vec<f64>) = (fields.get("low")?, fields.get("high")?);
        let scale: Vec<f64> = fields.get("scale")?;
        same_length(fields, "low", low.len(), scale.len())?;
        same_length(fields, "high", high.len(), scale.len())?;
        Ok(Self { dtype: FloatType::parse(fields)?, low, high, scale })
    }

    fn axes<T: Float>(&self, to_dtype: impl Fn(f64) -> T) -> Vec<Axis<T>> {
        let bounds = self.low.iter().zip(&self.high);
        bounds.zip(&self.scale).map(|((&low, &high), &scale)| Axis::new(to_dtype(low), to_dtype(high), scale)).collect()
    }

    /// The grid over `N` float32 components; None for any other number of components.
    pub(crate) fn rounding<const N: usize>(&self) -> Option<Rounding<f32, [Axis<f32>; N]>> {
        self.axes(|bound| bound as f32).try_into().ok().map(Rounding::new)
    }
}

impl BinsSpec {
    fn parse(fields: &Fields<'_>) -> PyResult<Self> {
        let edges: Vec<Vec<f64>> = fields.get("edges")?;
        let ascending = |edges: Vec<f64>| {
            if edges.is_sorted() && !edges.iter().any(|edge| edge.is_nan()) {
                return Ok(Edges::new(edges));
            }
            Err(invalid(&fields.path("edges"), "ascending numbers", format!("{edges:?}")))
        };
        let edges = edges.into_iter().map(ascending).collect::<PyResult<_>>()?;
        Ok(Self { dtype: FloatType::parse(fields)?, edges })
    }

    /// The bins over `N` float32 components; None for any other number of components.
    pub(crate) fn bins<const N: usize>(&self) -> Option<Bins<f32, [Edges; N]>> {
        self.edges.clone().try_into().ok().map(Bins::new)
    }
}

impl TilesSpec {
    fn parse(fields: &Fields<'_>) -> PyResult<Self> {
        let spec = Self {
            dtype: FloatType::parse(fields)?,
            low: fields.get("low")?,
            high: fields.get("high")?,
            tiles: fields.get("tiles")?,
            tilings: fields.get("tilings")?,
            hashed_rows: fields.get("hashed_rows")?,
        };
        same_length(fields, "low", spec.low.len(), spec.tiles.len())?;
        same_length(fields, "high", spec.high.len(), spec.tiles.len())?;
        if !(1..=MAX_TILINGS).contains(&(spec.tilings as usize)) {
            return Err(invalid(&fields.path("tilings"), format!("from 1 to {MAX_TILINGS}"), spec.tilings));
        }
        for ((&low, &high), &tiles) in spec.low.iter().zip(&spec.high).zip(&spec.tiles) {
            // Beyond these limits a tile's number would overflow.
            if !(low < high && (f64::from(tiles) / (high - low)).is_normal() && (high - low).is_finite()) {
                let got = format!("{low} to {high} with {tiles} tiles");
                return Err(invalid(&fields.path("low"), "less than high, and tiles at least 1", got));
            }
            if u64::from(tiles) * u64::from(spec.tilings) >= u64::from(u32::MAX) {
                return Err(invalid(&fields.path("tiles"), "less than 2**32 - 1, times tilings", tiles));
            }
        }
        if spec.hashed_rows == Some(0) {
            return Err(invalid(&fields.path("hashed_rows"), "at least 1", 0));
        }
        Ok(spec)
    }

    /// Tile coding with room for `M` tilings, which must be enough.
    pub(crate) fn tile_coding<T: Float, const M: usize>(&self) -> TileCoding<T, M> {
        let tiles = TileCoding::new(&self.low, &self.high, &self.tiles, self.tilings);
        match self.hashed_rows {
            Some(rows) => tiles.hashed(rows),
            None => tiles,
        }
    }
}

pub(super) fn same_length(fields: &Fields<'_>, name: &str, length: usize, expected: usize) -> PyResult<()> {
    if length == expected {
        return Ok(());
    }
    Err(invalid(&fields.path(name), format!("a list of length {expected}"), format!("length {length}")))
}
