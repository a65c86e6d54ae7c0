//! The powers of complex numbers, and the real parts of their products.

use std::f64::consts::PI;

/// The powers of a complex number: their real and their imaginary parts.
pub(super) struct Powers<const P: usize> {
    pub(super) re: [f64; P],
    pub(super) im: [f64; P],
}

impl<const P: usize> Powers<P> {
    #[inline]
    pub(super) fn new() -> Self {
        Self { re: [0.0; P], im: [0.0; P] }
    }

    /// The powers 0 to `count` - 1, at least 2, of e^(iπs).
    #[inline]
    pub(super) fn compute(&mut self, s: f64, count: usize) {
        let (re, im) = (&mut self.re[..count], &mut self.im[..count]);
        let angle = PI * s;
        (re[0], im[0]) = (1.0, 0.0);
        (re[1], im[1]) = (angle.cos(), angle.sin());
        for k in 2..count {
            let (m, n) = (k / 2, k - k / 2);
            (re[k], im[k]) = (re[n] * re[m] - im[n] * im[m], re[n] * im[m] + im[n] * re[m]);
        }
    }
}

/// Writes the real parts of the products of each number and each of `C` powers.
#[inline]
pub(super) fn write_real_products<const C: usize, const P: usize>(
    features: &mut [f64],
    numbers: &Powers<P>,
    re: &[f64],
    im: &[f64],
) {
    let (Some(re), Some(im)) = (re.first_chunk::<C>(), im.first_chunk::<C>()) else { return };
    let numbers = numbers.re.iter().zip(&numbers.im);
    for (features, (&number_re, &number_im)) in features.as_chunks_mut::<C>().0.iter_mut().zip(numbers) {
        write_row(features, (number_re, number_im), re, im);
    }
}

/// Writes the real parts of the products of a number and each power.
#[inline(always)]
pub(super) fn write_row(features: &mut [f64], (number_re, number_im): (f64, f64), re: &[f64], im: &[f64]) {
    for ((feature, re), im) in features.iter_mut().zip(re).zip(im) {
        *feature = number_re * re - number_im * im;
    }
}
