//! Features with values other than 1 (Sutton & Barto, section 9.5).

mod complex_powers;
mod feature_vector;
mod fourier_basis;
mod scaled_box;

pub use feature_vector::{FeatureVector, MAX_FEATURES};
pub use fourier_basis::FourierBasis;
