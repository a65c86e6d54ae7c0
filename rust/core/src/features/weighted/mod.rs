//! Features with values other than 1 (Sutton & Barto, section 9.5).

mod any_basis;
mod basis;
mod center_grid;
mod coarse_coding;
mod combinations;
mod complex_powers;
mod feature_vector;
mod fourier_basis;
mod multi_indices;
mod polynomial_basis;
mod radial_basis;
mod scaled_box;

pub use any_basis::AnyBasis;
pub use coarse_coding::CoarseCoding;
pub use feature_vector::{FeatureVector, MAX_FEATURES};
pub use fourier_basis::FourierBasis;
pub use polynomial_basis::PolynomialBasis;
pub use radial_basis::RadialBasis;
