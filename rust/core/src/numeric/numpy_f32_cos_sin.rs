//! `NumPy`'s single-precision cosine and sine.

/// Cosine and sine of an angle in [-π/4, π/4], as `NumPy`'s SIMD code computes them: two polynomials in Horner form with
/// fused multiply-adds. Source: `numpy/_core/src/umath/loops_trigonometric.dispatch.cpp`, without its range reduction.
///
/// Acrobot's first observation uses them (`np.cos` and `np.sin` of a float32 state).
pub fn numpy_f32_cos_sin(x: f32) -> [f32; 2] {
    // The coefficients of x⁸, x⁶, x⁴, x², 1 and of x⁹, x⁷, x⁵, x³.
    const COSINE: [f32; 5] =
        [f32::from_bits(0x37cc_730b), f32::from_bits(0xbab6_036e), f32::from_bits(0x3d2a_aa9e), -0.5, 1.0];
    const SINE: [f32; 4] = [
        f32::from_bits(0x363e_9dde),
        f32::from_bits(0xb950_35dd),
        f32::from_bits(0x3c08_88cd),
        f32::from_bits(0xbe2a_aaab),
    ];
    let square = x * x;
    let horner = |factors: &[f32]| factors[1..].iter().fold(factors[0], |sum, &next| sum.mul_add(square, next));
    [horner(&COSINE), (horner(&SINE) * square).mul_add(x, x)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_angles_match_numpy_even_where_it_is_not_correctly_rounded() {
        // Printed by NumPy 2.4. The last bit is not the nearest in the first and third cosine and in the second sine.
        for [angle, cosine, sine] in [
            [0x3db4_86ce, 0x3f7f_018e, 0x3db4_4afb],
            [0x3db4_2547, 0x3f7f_02a1, 0x3db3_e9d4],
            [0xbd71_a4ec, 0x3f7f_8dfc, 0xbd71_810b],
        ] {
            assert_eq!(numpy_f32_cos_sin(f32::from_bits(angle)).map(f32::to_bits), [cosine, sine]);
        }
    }
}
