//! A generator in Rust as a `bitgen_t`.

#![expect(unsafe_code, reason = "functions in C receive the address of a generator")]

use std::ffi::c_void;
use std::marker::PhantomData;
use std::ptr;

use crate::Bitgen;

/// 2⁻⁵³.
const TWO_POW_MINUS_53: f64 = 1.0 / 9_007_199_254_740_992.0;

/// A generator of random bits.
pub trait BitGenerator {
    /// The next 64 random bits.
    fn next_u64(&mut self) -> u64;

    /// The next 32 random bits.
    fn next_u32(&mut self) -> u32;

    /// The next float in [0, 1).
    #[inline]
    fn next_f64(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 * TWO_POW_MINUS_53
    }
}

/// Random bits for one call of a function in C.
#[derive(Debug)]
pub struct RandomBits<'a> {
    pub(super) bitgen: Bitgen,
    exclusive: PhantomData<&'a mut ()>,
}

impl<'a> RandomBits<'a> {
    /// The bits of a generator in Rust.
    #[inline]
    pub fn new<G: BitGenerator>(generator: &'a mut G) -> Self {
        let bitgen = Bitgen {
            state: ptr::from_mut(generator).cast(),
            next_uint64: next_uint64::<G>,
            next_uint32: next_uint32::<G>,
            next_double: next_double::<G>,
            next_raw: next_uint64::<G>,
        };
        Self { bitgen, exclusive: PhantomData }
    }

    /// The bits of a generator in C, such as one of `NumPy`'s.
    ///
    /// # Safety
    /// The functions of `bitgen` may be called with its `state`, and nothing else calls them, as long as this value
    /// lives.
    pub unsafe fn from_bitgen(bitgen: Bitgen) -> Self {
        Self { bitgen, exclusive: PhantomData }
    }
}

unsafe extern "C" fn next_uint64<G: BitGenerator>(state: *mut c_void) -> u64 {
    // SAFETY: `RandomBits::new` has borrowed the generator exclusively, and its functions are the only users.
    unsafe { &mut *state.cast::<G>() }.next_u64()
}

unsafe extern "C" fn next_uint32<G: BitGenerator>(state: *mut c_void) -> u32 {
    // SAFETY: as in `next_uint64`.
    unsafe { &mut *state.cast::<G>() }.next_u32()
}

unsafe extern "C" fn next_double<G: BitGenerator>(state: *mut c_void) -> f64 {
    // SAFETY: as in `next_uint64`.
    unsafe { &mut *state.cast::<G>() }.next_f64()
}
