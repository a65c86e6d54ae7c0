//! `NumPy`'s single-precision cosine and sine.

/// The cosine and the sine of a single-precision angle within ±π/4, as `NumPy`'s vector code computes them: two
/// polynomials, each step one fused multiply-add (its `loops_trigonometric`; other angles are brought there first).
pub fn numpy_f32_cos_sin(x: f32) -> [f32; 2] {
    // x⁸, x⁶, x⁴, x², 1 and x⁹, x⁷, x⁵, x³
    const COSINE: [f32; 5] =
        [f32::from_bits(0x37cc_730b), f32::from_bits(0xbab6_036e), f32::from_bits(0x3d2a_aa9e), -0.5, 1.0];
    const SINE: [f32; 4] = [
        f32::from_bits(0x363e_9dde),
        f32::from_bits(0xb950_35dd),
        f32::from_bits(0x3c08_88cd),
        f32::from_bits(0xbe2a_aaab),
    ];
    let square = x * x;
    let polynomial = |factors: &[f32]| factors[1..].iter().fold(factors[0], |sum, &next| sum.mul_add(square, next));
    [polynomial(&COSINE), (polynomial(&SINE) * square).mul_add(x, x)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_angles_have_numpys_last_bit_where_it_is_not_the_nearest() {
        // As NumPy 2.4 printed them; the cosine's last bit is off in the first and the third, the sine's in the second.
        for [angle, cosine, sine] in [
            [0x3db4_86ce, 0x3f7f_018e, 0x3db4_4afb],
            [0x3db4_2547, 0x3f7f_02a1, 0x3db3_e9d4],
            [0xbd71_a4ec, 0x3f7f_8dfc, 0xbd71_810b],
        ] {
            assert_eq!(numpy_f32_cos_sin(f32::from_bits(angle)).map(f32::to_bits), [cosine, sine]);
        }
    }
}
