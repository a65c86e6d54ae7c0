//! How a rate falls from episode to episode.

/// The rule by which it falls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Decay {
    /// It stays.
    Constant,
    /// By the same amount after every episode while it is above the least: the article's rule. Not clamped, as there: it
    /// may end a few 1e-14 past the least.
    Linear {
        /// The amount.
        reduction: f64,
    },
    /// By the same factor after every episode, one multiplication each, and not below the least.
    Exponential {
        /// The factor.
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
}

impl Schedule {
    /// Always `value`.
    pub fn constant(value: f64) -> Self {
        Self { value, min: value, warm_up: 0, decay: Decay::Constant }
    }

    /// From `value` down to `least` over the `episodes` that follow the `warm_up`.
    ///
    /// # Panics
    /// If the warm-up takes all the episodes.
    pub fn linear(value: f64, min: f64, episodes: u64, warm_up: u64) -> Self {
        assert!(warm_up < episodes, "a warm-up of {warm_up} leaves none of {episodes} episodes");
        let reduction = (value - min) / (episodes - warm_up) as f64;
        Self { value, min, warm_up, decay: Decay::Linear { reduction } }
    }

    /// `value` times `factor` after each episode that follows the `warm_up`, down to `least`.
    pub fn exponential(value: f64, min: f64, factor: f64, warm_up: u64) -> Self {
        Self { value, min, warm_up, decay: Decay::Exponential { factor } }
    }

    /// The rate now.
    #[inline]
    pub fn value(&self) -> f64 {
        self.value
    }

    /// One episode later.
    pub fn end_episode(&mut self) {
        if self.warm_up > 0 {
            self.warm_up -= 1;
        } else if self.value > self.min {
            match self.decay {
                Decay::Constant => {}
                Decay::Linear { reduction } => self.value -= reduction,
                Decay::Exponential { factor } => self.value = (self.value * factor).max(self.min),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn course(mut schedule: Schedule) -> [f64; 4] {
        std::array::from_fn(|_| {
            let value = schedule.value();
            schedule.end_episode();
            value
        })
    }

    #[test]
    fn each_rule_falls_as_it_says() {
        assert_eq!(course(Schedule::constant(0.5)), [0.5; 4]);
        assert_eq!(course(Schedule::linear(1.0, 0.5, 2, 0)), [1.0, 0.75, 0.5, 0.5]);
        assert_eq!(course(Schedule::exponential(1.0, 0.2, 0.5, 0)), [1.0, 0.5, 0.25, 0.2]);
    }

    #[test]
    fn nothing_falls_during_the_warm_up() {
        assert_eq!(course(Schedule::linear(1.0, 0.0, 4, 2)), [1.0, 1.0, 1.0, 0.5]);
        assert_eq!(course(Schedule::exponential(1.0, 0.0, 0.5, 1)), [1.0, 1.0, 0.5, 0.25]);
    }
}
