//! The common parts of the lane types.

/// An operand in lanes: `L`, or a number that is the same in all lanes.
pub(crate) trait InLanes<S, L> {
    fn in_lanes(self, simd: S) -> L;
}

/// Defines the conversions of a lane type from and to an array, and its operators. It takes the type, the type of one
/// lane, the operations from and to an array, and the operations of the operators.
macro_rules! lane_type {
    ($lanes:ident, $lane:ty, $from_array:ident, $to_array:ident, $($trait:ident $method:ident $operation:ident),+) => {
        impl<S: Simd, const K: usize> $lanes<S, K> {
            #[inline(always)]
            pub(crate) fn new(simd: S, array: [$lane; K]) -> Self {
                Self(simd, simd.$from_array(array))
            }

            #[inline(always)]
            pub(crate) fn to_array(self) -> [$lane; K] {
                self.0.$to_array(self.1)
            }

            /// Replaces the value of one lane.
            #[inline(always)]
            pub(crate) fn set(&mut self, lane: usize, new: $lane) {
                let mut array = self.to_array();
                array[lane] = new;
                *self = Self::new(self.0, array);
            }
        }

        impl<S: Simd, const K: usize> InLanes<S, Self> for $lanes<S, K> {
            #[inline(always)]
            fn in_lanes(self, _simd: S) -> Self {
                self
            }
        }

        $(
            impl<S: Simd, T: InLanes<S, Self>, const K: usize> $trait<T> for $lanes<S, K> {
                type Output = Self;

                #[inline(always)]
                fn $method(self, other: T) -> Self {
                    Self(self.0, self.0.$operation(self.1, other.in_lanes(self.0).1))
                }
            }
        )+
    };
}

pub(super) use lane_type;

/// `array.map(f)`, always inlined. The compiler may call the standard one instead, which is then not compiled for the
/// instruction set of its caller. Only for lanes: for single numbers, the standard one compiles to faster code.
#[inline(always)]
pub(crate) fn map<T: Copy, U: Copy, const N: usize>(array: [T; N], f: impl Fn(T) -> U) -> [U; N] {
    const { assert!(N > 0, "the array must not be empty") };
    let mut results = [f(array[0]); N];
    for (result, &element) in results.iter_mut().zip(&array).skip(1) {
        *result = f(element);
    }
    results
}
