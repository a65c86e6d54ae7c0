//! Bins between edges, as in `np.digitize`. Values beyond the limits belong to the outermost bins.

use std::marker::PhantomData;

use super::{BatchFeatures, Features, OutOfBounds};
use crate::errors::BuildError;
use crate::numeric::Float;
use crate::simd::{F32s, F64s, Mask, Simd, U64s};

/// Up to this many edges are compared one by one, without a branch. Beyond that, a binary search is used.
const LINEAR_SCAN_MAX: usize = 64;

/// The inner edges of the bins of one component, in ascending order. Float32 edges are stored as f64, which does not
/// change any comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct Edges(Vec<f64>);

impl Edges {
    /// Bins between the given edges.
    ///
    /// # Panics
    /// If the edges are not ascending, or one is NaN.
    pub fn new(edges: Vec<f64>) -> Self {
        assert!(is_ascending(&edges), "edges must be ascending");
        Self(edges)
    }

    /// Bins of equal width, as in Gymnasium's `DiscretizeObservation`: `np.linspace(low, high, bins + 1)[1:-1]`,
    /// computed in the dtype of the bounds.
    pub fn equal_width<T: Float>(low: T, high: T, bins: u32) -> Self {
        let width = (high - low) / T::from_count(bins);
        Self::new((1..bins).map(|edge| (T::from_count(edge) * width + low).into()).collect())
    }

    /// As [`new`](Self::new), checked.
    ///
    /// # Errors
    /// If the edges are not ascending, or one is NaN.
    pub fn try_new(edges: Vec<f64>) -> Result<Self, BuildError> {
        BuildError::check(is_ascending(&edges), "edges", "ascending numbers", format_args!("{edges:?}"))?;
        Ok(Self(edges))
    }

    /// The number of bins, one more than edges.
    pub fn bins(&self) -> usize {
        self.0.len() + 1
    }

    /// `np.digitize(value, edges)`: an edge belongs to the bin above it.
    #[inline]
    fn bin(&self, value: f64) -> u32 {
        if self.0.len() <= LINEAR_SCAN_MAX {
            return self.0.iter().map(|&edge| u32::from(edge <= value)).sum();
        }
        self.0.partition_point(|&edge| edge <= value) as u32
    }

    /// [`bin`](Self::bin) of the values in each lane.
    #[inline(always)]
    fn bin_in_lanes<S: Simd, const K: usize>(&self, simd: S, values: F64s<S, K>) -> U64s<S, K> {
        if self.0.len() > LINEAR_SCAN_MAX {
            return U64s::new(simd, values.to_array().map(|value| self.bin(value).into()));
        }
        let mut bins = U64s::splat(simd, 0);
        for &edge in &self.0 {
            bins = bins.incremented_where(values.greater_or_equal(edge));
        }
        bins
    }
}

fn is_ascending(edges: &[f64]) -> bool {
    edges.is_sorted() && !edges.iter().any(|edge| edge.is_nan())
}

/// A grid of bins for observations of dtype `T`: one row per cell, in C order.
#[derive(Clone, Debug, PartialEq)]
pub struct Bins<T, A = Vec<Edges>> {
    axes: A,
    dtype: PhantomData<T>,
}

impl<T: Float, A: AsRef<[Edges]>> Bins<T, A> {
    /// The grid with these edges along each component.
    pub fn new(axes: A) -> Self {
        Self { axes, dtype: PhantomData }
    }

    /// The number of cells, each of which has a row of the table.
    pub fn n_rows(&self) -> usize {
        Features::<[T]>::len(self)
    }
}

impl<T: Float, A: AsRef<[Edges]>, O: AsRef<[T]> + ?Sized> Features<O> for Bins<T, A> {
    type Active = [u32; 1];

    #[expect(clippy::inline_always, reason = "a call per step would take a tenth of its time")]
    #[inline(always)]
    fn active_rows(&self, observation: &O) -> Result<[u32; 1], OutOfBounds> {
        let mut row = 0;
        for (axis, (edges, &value)) in self.axes.as_ref().iter().zip(observation.as_ref()).enumerate() {
            let value = value.into();
            if value.is_nan() {
                return Err(OutOfBounds { axis, value });
            }
            row = row * edges.bins() as u32 + edges.bin(value);
        }
        Ok([row])
    }

    fn len(&self) -> usize {
        self.axes.as_ref().iter().map(Edges::bins).product()
    }
}

impl<const M: usize> BatchFeatures<M> for Bins<f32, [Edges; M]> {
    type ActiveInLane = usize;

    #[inline(always)]
    fn write_active_rows_batch<S: Simd, const K: usize>(
        &self,
        simd: S,
        observations: [F32s<S, K>; M],
        active: &mut [usize; K],
    ) -> bool {
        let mut rows = U64s::splat(simd, 0);
        let mut numbers = Mask::new(simd, [true; K]);
        for (edges, values) in self.axes.iter().zip(observations) {
            let values = values.to_f64s();
            // Rows are below 2³².
            rows = rows.mul_lower(edges.bins() as u64) + edges.bin_in_lanes(simd, values);
            // NaN does not equal itself.
            numbers = numbers & values.equal(values);
        }
        *active = rows.to_array().map(|row| row as usize);
        !(!numbers).any()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_belongs_to_the_bin_above_it() {
        let edges = Edges::equal_width(0.0_f64, 4.0, 4);
        assert_eq!([0.0, 0.99, 1.0, 3.0].map(|value| edges.bin(value)), [0, 0, 1, 3]);
    }

    #[test]
    fn values_beyond_the_limits_belong_to_the_outermost_bins() {
        let grid = Bins::new([Edges::equal_width(-1.0_f32, 1.0, 4)]);
        assert_eq!(grid.active_rows(&[-9.0_f32]), Ok([0]));
        assert_eq!(grid.active_rows(&[f32::INFINITY]), Ok([3]));
    }

    #[test]
    fn the_binary_search_agrees_with_the_linear_scan() {
        let many = Edges::new((0..200).map(f64::from).collect());
        for value in [-1.0, 0.0, 0.5, 77.0, 198.99, 199.0, 1e9] {
            assert_eq!(many.bin(value), many.0.iter().map(|&edge| u32::from(edge <= value)).sum::<u32>());
        }
    }

    #[test]
    fn nan_has_no_bin() {
        assert!(Bins::new([Edges::equal_width(-1.0_f32, 1.0, 4)]).active_rows(&[f32::NAN]).is_err());
    }

    #[test]
    fn edges_can_be_checked() {
        assert_eq!(Edges::try_new(vec![0.0, 1.0]), Ok(Edges::new(vec![0.0, 1.0])));
        let error = Edges::try_new(vec![1.0, 0.0]).map_err(|error| error.to_string());
        assert_eq!(error, Err("edges must be ascending numbers, got [1.0, 0.0]".into()));
    }

    #[test]
    #[should_panic(expected = "must be ascending")]
    fn descending_edges_are_refused() {
        Edges::new(vec![1.0, 0.0]);
    }
}
