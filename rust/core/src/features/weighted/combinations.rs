//! A feature for each combination of numbers of the components, such as the products of their powers.

use super::scaled_box::ScaledBox;
use crate::features::OutOfBounds;
use crate::numeric::Float;

/// The number of values of a component for which small bases have room. The room is cleared at every step, so less is faster.
pub(super) const SMALL: usize = 16;

/// All combinations of one of `counts[j]` numbers of each component j, in C order.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Combinations {
    counts: Vec<usize>,
    len: usize,
    /// Whether no component has more than [`SMALL`] numbers.
    is_small: bool,
}

impl Combinations {
    /// `None` if there are more than `most`, no component, or a component without numbers.
    pub(super) fn new(counts: Vec<usize>, most: usize) -> Option<Self> {
        let len = counts.iter().try_fold(1_usize, |len, &count| len.checked_mul(count))?;
        let is_small = counts.iter().all(|&count| count <= SMALL);
        (len > 0 && len <= most && !counts.is_empty()).then_some(Self { counts, len, is_small })
    }

    /// The number of combinations.
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Writes a feature for each combination: its numbers, combined by `combine` from the first component to the last.
    /// `write_numbers` writes the numbers of a component, of which it receives the index and the value in [0, 1]. `M` is at
    /// least [`len`](Self::len).
    #[inline]
    pub(super) fn write<T: Float, const M: usize>(
        &self,
        scaled: &ScaledBox,
        observation: &[T],
        features: &mut [f64],
        write_numbers: impl Fn(usize, f64, &mut [f64]),
        combine: impl Fn(f64, f64) -> f64,
    ) -> Result<(), OutOfBounds> {
        if self.is_small {
            self.write_in::<T, SMALL>(scaled, observation, features, write_numbers, combine)
        } else {
            self.write_in::<T, M>(scaled, observation, features, write_numbers, combine)
        }
    }

    #[inline]
    fn write_in<T: Float, const P: usize>(
        &self,
        scaled: &ScaledBox,
        observation: &[T],
        features: &mut [f64],
        write_numbers: impl Fn(usize, f64, &mut [f64]),
        combine: impl Fn(f64, f64) -> f64,
    ) -> Result<(), OutOfBounds> {
        let mut room = [0.0; P];
        let mut len = 1;
        for (axis, (&value, &count)) in observation.iter().zip(&self.counts).enumerate() {
            let numbers = &mut room[..count];
            write_numbers(axis, scaled.scale(axis, value.into())?, numbers);
            if axis == 0 {
                features[..count].copy_from_slice(numbers);
            } else {
                // From the last combination, because the new ones overwrite those after it.
                for index in (0..len).rev() {
                    let first = features[index];
                    for (feature, &number) in features[index * count..][..count].iter_mut().zip(&*numbers) {
                        *feature = combine(first, number);
                    }
                }
            }
            len *= count;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(counts: &[usize], combine: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        let combinations = Combinations::new(counts.to_vec(), 256).expect("few combinations");
        let scaled = ScaledBox::try_new(&vec![0.0; counts.len()], &vec![2.0; counts.len()]).expect("a box");
        let mut features = vec![f64::NAN; combinations.len()];
        // The numbers of component j are s + 10ʲ (1, 2, …).
        let write = |axis: usize, s: f64, numbers: &mut [f64]| {
            for (number, index) in numbers.iter_mut().zip(1_u32..) {
                *number = s + 10_f64.powf(axis as f64) * f64::from(index);
            }
        };
        let observation = vec![1.0; counts.len()];
        combinations.write::<f64, 256>(&scaled, &observation, &mut features, write, combine).expect("no NaN");
        features
    }

    #[test]
    fn the_last_component_changes_fastest() {
        assert_eq!(written(&[3], |a, b| a + b), [1.5, 2.5, 3.5]);
        assert_eq!(written(&[2, 3], |a, b| a + b), [12.0, 22.0, 32.0, 13.0, 23.0, 33.0]);
        assert_eq!(written(&[2, 1, 2], |a, b| a - b), [-109.5, -209.5, -108.5, -208.5]);
        let wide = written(&[2, 100], |a, b| a * b);
        assert_eq!(wide.len(), 200);
        assert_eq!([wide[0], wide[199]], [1.5 * 10.5, 2.5 * 1000.5]);
    }

    #[test]
    fn too_many_combinations_are_refused() {
        assert_eq!(Combinations::new(vec![16, 17], 256), None);
        assert_eq!(Combinations::new(vec![usize::MAX, 3], 256), None);
        assert_eq!(Combinations::new(vec![], 256), None);
        assert_eq!(Combinations::new(vec![4, 0], 256), None);
        assert!(Combinations::new(vec![16, 16], 256).is_some_and(|combinations| combinations.len() == 256));
    }
}
