//! The trait of the active features of an observation: what a learner multiplies its weights by.

/// The features of an observation that are not zero: their rows, and their values.
///
/// Features are *binary* unless a type says otherwise: each active feature is 1, and a value is the sum over the rows, as
/// on a grid and in tile coding. Types with [`WEIGHTED`](Self::WEIGHTED) features give each row a number xᵢ(s): their rows
/// are all rows of the table, in order. A learner then computes (Sutton & Barto, section 9.4)
///
/// - q(s, a) = Σᵢ wᵢ xᵢ as four partial sums: p₀ of the products 0, 4, 8, …, p₁ of the products 1, 5, 9, … and so on, each
///   from left to right, then (p₀ + p₁) + (p₂ + p₃);
/// - wᵢ ← wᵢ + (αᵢ δ) xᵢ, in this order of the multiplications.
///
/// The choice is made at compile time, so binary features do not multiply.
///
/// ```
/// use qtab_core::features::ActiveFeatures;
///
/// /// Two tilings of a type that is not in this crate.
/// #[derive(Clone, Copy)]
/// struct Pair([u32; 2]);
///
/// impl AsRef<[u32]> for Pair {
///     fn as_ref(&self) -> &[u32] {
///         &self.0
///     }
/// }
///
/// impl ActiveFeatures for Pair {}
/// assert!(!Pair::WEIGHTED);
/// ```
pub trait ActiveFeatures: AsRef<[u32]> {
    /// Whether the features have values other than 1.
    const WEIGHTED: bool = false;

    /// The value of each feature, in the order of the rows. Only weighted features have values.
    #[inline]
    fn values(&self) -> &[f64] {
        &[]
    }

    /// Weighted features with these values, as they were saved; `None` if there are too many, or if the features are
    /// binary.
    fn from_values(_values: &[f64]) -> Option<Self>
    where
        Self: Sized,
    {
        None
    }
}

/// Checks that features are binary, for code that reads their rows, but does not multiply by their values. The compiler
/// removes the check.
///
/// # Panics
/// For weighted features.
#[inline(always)]
#[track_caller]
pub(crate) fn assert_binary<R: ActiveFeatures>() {
    assert!(
        !R::WEIGHTED,
        "this algorithm, policy or task needs binary features: see ActiveFeatures and AnyAlgorithm::feature_kinds"
    );
}

impl<F: ActiveFeatures + ?Sized> ActiveFeatures for &F {
    const WEIGHTED: bool = F::WEIGHTED;

    #[inline(always)]
    fn values(&self) -> &[f64] {
        F::values(self)
    }
}

impl ActiveFeatures for [u32] {}

impl<const N: usize> ActiveFeatures for [u32; N] {}

impl ActiveFeatures for Vec<u32> {}
