//! Rates that change from episode to episode.

/// The change of a rate after an episode.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Decay {
    /// Subtracts a constant while the rate is above its minimum. The result is not clamped, as in the article, so
    /// rounding may leave it a few 1e-14 below the minimum.
    Linear {
        /// The amount subtracted after each episode.
        reduction: f64,
    },
    /// Multiplies by a constant, down to the minimum.
    Exponential {
        /// The factor applied after each episode.
        factor: f64,
    },
}

/// A rate that changes between episodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schedule {
    value: f64,
    min: f64,
    warm_up: u64,
    decay: Decay,
    /// Whether the rate has stopped changing.
    is_final: bool,
}

impl Schedule {
    /// The constant `value`.
    pub fn constant(value: f64) -> Self {
        Self { value, min: value, warm_up: 0, decay: Decay::Linear { reduction: 0.0 }, is_final: true }
    }

    /// `value` for the first `warm_up` episodes, then a linear decay to `min` over the rest of the `episodes`.
    ///
    /// # Panics
    /// If `warm_up` is not less than `episodes`.
    pub fn linear(value: f64, min: f64, episodes: u64, warm_up: u64) -> Self {
        assert!(warm_up < episodes, "warm_up must be less than episodes ({episodes}), got {warm_up}");
        let reduction = (value - min) / (episodes - warm_up) as f64;
        Self { value, min, warm_up, decay: Decay::Linear { reduction }, is_final: false }
    }

    /// `value` for the first `warm_up` episodes, then multiplied by `factor` after each episode, down to `min`.
    pub fn exponential(value: f64, min: f64, factor: f64, warm_up: u64) -> Self {
        Self { value, min, warm_up, decay: Decay::Exponential { factor }, is_final: false }
    }

    /// The rate of the current episode.
    #[inline]
    pub fn value(&self) -> f64 {
        self.value
    }

    /// Whether the rate has stopped changing.
    #[inline]
    pub(crate) fn is_final(&self) -> bool {
        self.is_final
    }

    /// Moves on to the next episode.
    #[inline]
    pub fn end_episode(&mut self) {
        // A single comparison suffices for a final rate. It matters for bandits, whose episodes are single steps.
        if self.is_final {
            return;
        }
        if self.warm_up > 0 {
            self.warm_up -= 1;
        } else if self.value > self.min {
            match self.decay {
                Decay::Linear { reduction } => self.value -= reduction,
                Decay::Exponential { factor } => self.value = (self.value * factor).max(self.min),
            }
        } else {
            self.is_final = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first_four(mut schedule: Schedule) -> [f64; 4] {
        std::array::from_fn(|_| {
            let value = schedule.value();
            schedule.end_episode();
            value
        })
    }

    #[test]
    fn each_decay_follows_its_rule() {
        assert_eq!(first_four(Schedule::constant(0.5)), [0.5; 4]);
        assert_eq!(first_four(Schedule::linear(1.0, 0.5, 2, 0)), [1.0, 0.75, 0.5, 0.5]);
        assert_eq!(first_four(Schedule::exponential(1.0, 0.2, 0.5, 0)), [1.0, 0.5, 0.25, 0.2]);
    }

    #[test]
    fn rates_are_constant_during_the_warm_up() {
        assert_eq!(first_four(Schedule::linear(1.0, 0.0, 4, 2)), [1.0, 1.0, 1.0, 0.5]);
        assert_eq!(first_four(Schedule::exponential(1.0, 0.0, 0.5, 1)), [1.0, 1.0, 0.5, 0.25]);
    }
}
