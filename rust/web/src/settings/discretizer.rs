//! The discretizer of a request.

use qtab_core::features::{AnyGrid, Axis, Bins, Edges, FourierBasis, MAX_TILINGS, Rounding, TileCoding};
use qtab_core::settings::SettingSource;

use super::fields::Fields;
use crate::environment::Bounds;
use crate::failure::Failure;

/// The largest number of rows of a table.
const MAX_ROWS: u64 = 1 << 24;
/// The largest number of weighted features. A step copies them, so there is room for fewer than in Python.
pub(crate) const MAX_FEATURES: usize = 256;
/// Larger limits would overflow float32, the precision of grids.
const LARGEST_LIMIT: f64 = 1e30;

/// A discretizer of the observations, with its features.
#[derive(Clone, Debug)]
pub(crate) enum Discretizer {
    /// States that are already numbers.
    Identity,
    Grid(Grid),
    Tiles {
        features: Box<TileCoding<f32, MAX_TILINGS>>,
        tilings: usize,
        limits: Vec<(f64, f64)>,
    },
    Fourier {
        features: FourierBasis<f32, MAX_FEATURES>,
        limits: Vec<(f64, f64)>,
    },
}

/// A grid, and the edges of its cells along each component.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    pub(crate) features: AnyGrid<f32>,
    pub(crate) edges: Vec<Vec<f64>>,
}

impl Discretizer {
    pub(crate) fn parse(fields: &Fields<'_>, bounds: Option<Bounds>) -> Result<Self, Failure> {
        let Some(bounds) = bounds else {
            fields.word("discretizer", &[("identity", ())])?;
            return Ok(Self::Identity);
        };
        let parsers: [(&str, Parser); 4] =
            [("round", rounding), ("bins", bins), ("tiles", tiles), ("fourier", fourier)];
        let is_bounded = bounds.iter().all(|(low, high)| low.is_finite() && high.is_finite());
        // Rounding needs bounds.
        fields.word("discretizer", &parsers[usize::from(!is_bounded)..])?(fields, bounds)
    }

    /// The number of rows that are active at a time.
    pub(crate) fn n_active(&self) -> usize {
        match self {
            Self::Identity | Self::Grid(_) => 1,
            Self::Tiles { tilings, .. } => *tilings,
            Self::Fourier { features, .. } => features.n_features(),
        }
    }

    /// Whether the features are weighted.
    pub(crate) fn is_weighted(&self) -> bool {
        matches!(self, Self::Fourier { .. })
    }

    /// The numbers that divide the learning rate of each row of weighted features, which may be none; `None` for other
    /// features.
    pub(crate) fn step_size_divisors(&self) -> Option<Vec<f64>> {
        match self {
            Self::Identity | Self::Grid(_) | Self::Tiles { .. } => None,
            Self::Fourier { features, .. } => Some(features.divisors()),
        }
    }

    /// The limits of each component; `None` if there are cells, or states that are numbers.
    pub(crate) fn limits(&self) -> Option<&[(f64, f64)]> {
        match self {
            Self::Identity | Self::Grid(_) => None,
            Self::Tiles { limits, .. } | Self::Fourier { limits, .. } => Some(limits),
        }
    }
}

type Parser = fn(&Fields<'_>, Bounds) -> Result<Discretizer, Failure>;

fn rounding(fields: &Fields<'_>, bounds: Bounds) -> Result<Discretizer, Failure> {
    let scale = fields.numbers("scale", bounds.len())?.unwrap_or_default();
    if scale.len() != bounds.len() || scale.iter().any(|&scale| scale <= 0.0) {
        return Err(fields.invalid("scale", &format!("{} positive numbers", bounds.len())));
    }
    let axes: Vec<Axis<f32>> =
        bounds.iter().zip(&scale).map(|(&(low, high), &scale)| Axis::new(low, high, scale)).collect();
    check_rows(fields, "scale", axes.iter().map(|axis| axis.size() as u64))?;
    let edges = axes.iter().zip(bounds).zip(&scale).map(|((axis, &(low, high)), &scale)| {
        let (low, high) = (f64::from(low), f64::from(high));
        (0..=axis.size()).map(|edge| (low + (edge as f64 - 0.5) / scale).clamp(low, high)).collect()
    });
    Ok(Discretizer::Grid(Grid { edges: edges.collect(), features: AnyGrid::Rounding(Rounding::new(axes)) }))
}

fn bins(fields: &Fields<'_>, bounds: Bounds) -> Result<Discretizer, Failure> {
    let limits = limits(fields, bounds)?;
    let counts = fields.integers("bins", bounds.len(), 1_000_000)?;
    check_rows(fields, "bins", counts.iter().map(|&count| count.into()))?;
    let bins = limits.iter().zip(&counts);
    let edges = bins.clone().map(|(&(low, high), &count)| Edges::equal_width(low as f32, high as f32, count)).collect();
    let drawn = bins.map(|(&(low, high), &count)| {
        (0..=count).map(|edge| low + (high - low) * f64::from(edge) / f64::from(count)).collect()
    });
    Ok(Discretizer::Grid(Grid { edges: drawn.collect(), features: AnyGrid::Bins(Bins::new(edges)) }))
}

fn tiles(fields: &Fields<'_>, bounds: Bounds) -> Result<Discretizer, Failure> {
    let limits = limits(fields, bounds)?;
    let tilings = fields.integer("tilings", 1, MAX_TILINGS as u64)? as u32;
    let tiles = fields.integers("tiles", bounds.len(), 1_000_000)?;
    let along = tiles.iter().map(|&count| u64::from(count) + 1);
    check_rows(fields, "tiles", [u64::from(tilings)].into_iter().chain(along))?;
    let (low, high): (Vec<f64>, Vec<f64>) = limits.iter().copied().unzip();
    let features = Box::new(TileCoding::new(&low, &high, &tiles, tilings));
    Ok(Discretizer::Tiles { features, tilings: tilings as usize, limits })
}

fn fourier(fields: &Fields<'_>, bounds: Bounds) -> Result<Discretizer, Failure> {
    let limits = limits(fields, bounds)?;
    let order = fields.integer("order", 1, MAX_FEATURES as u64)? as u32;
    let (coupled, scales_step_sizes) = (fields.flag("coupled")?, fields.flag("scale_step_sizes")?);
    let (low, high): (Vec<f64>, Vec<f64>) = limits.iter().copied().unzip();
    let features = FourierBasis::try_new(&low, &high, order, coupled, scales_step_sizes).map_err(|_| {
        let expected = format!("small enough for {MAX_FEATURES} features with {} components", limits.len());
        fields.invalid("order", &expected)
    })?;
    Ok(Discretizer::Fourier { features, limits })
}

/// The lower and the upper limit of each component: the given ones, or those of the observation space.
fn limits(fields: &Fields<'_>, bounds: Bounds) -> Result<Vec<(f64, f64)>, Failure> {
    let (low, high) = (fields.numbers("low", bounds.len())?, fields.numbers("high", bounds.len())?);
    let mut limits = Vec::new();
    for (index, &(lower, upper)) in bounds.iter().enumerate() {
        let lower = low.as_ref().map_or(f64::from(lower), |low| low[index]);
        let upper = high.as_ref().map_or(f64::from(upper), |high| high[index]);
        if !(lower.abs() < LARGEST_LIMIT && upper.abs() < LARGEST_LIMIT) {
            return Err(fields.invalid("low", "given with high, as the observation space has no bounds"));
        }
        // Compared as float32, the precision of bins, and far enough apart for the number of tiles per unit.
        if !((lower as f32) < upper as f32 && upper - lower > f64::from(f32::MIN_POSITIVE)) {
            return Err(fields.invalid("low", "below high in each component"));
        }
        limits.push((lower, upper));
    }
    Ok(limits)
}

fn check_rows(fields: &Fields<'_>, name: &'static str, mut counts: impl Iterator<Item = u64>) -> Result<(), Failure> {
    let rows = counts.try_fold(1_u64, u64::checked_mul).filter(|rows| *rows <= MAX_ROWS);
    rows.map(|_| ()).ok_or_else(|| fields.invalid(name, &format!("such that the table has at most {MAX_ROWS} rows")))
}
