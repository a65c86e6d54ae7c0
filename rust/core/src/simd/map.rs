//! Arrays in code that is compiled per instruction set.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

/// `array.map(f)`, always inlined. The compiler may call the standard one instead, which is then not compiled for the
/// instruction set of its caller. For lanes: of single numbers the standard one makes faster code.
#[inline(always)]
pub(crate) fn map<T: Copy, U: Copy, const N: usize>(array: [T; N], f: impl Fn(T) -> U) -> [U; N] {
    const { assert!(N > 0, "the array must not be empty") };
    let mut results = [f(array[0]); N];
    for (result, &element) in results.iter_mut().zip(&array).skip(1) {
        *result = f(element);
    }
    results
}
