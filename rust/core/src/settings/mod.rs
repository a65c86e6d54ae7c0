//! The settings of a learner by their names in `qtab.Config`, from any source: a Python dict, or JSON.

mod algorithm;
mod policy;
mod schedule;

pub use algorithm::AlgorithmRows;
pub(crate) use algorithm::range_of;
pub use policy::PolicySpec;
pub use schedule::{LearningRateSpec, SCHEDULES, ScheduleSpec};

/// The smallest number above 0, as a bound of [`SettingSource::number`].
pub const ABOVE_ZERO: f64 = f64::from_bits(1);

/// A source of settings. Each reader returns an error for a missing setting, and `None` for one of another type.
pub trait SettingSource {
    /// The error for a missing or invalid setting.
    type Error;

    /// Whether there is a setting of this name.
    fn has(&self, name: &str) -> bool;

    /// A number.
    ///
    /// # Errors
    /// If there is no such setting.
    fn any_number(&self, name: &'static str) -> Result<Option<f64>, Self::Error>;

    /// An integer that is not negative.
    ///
    /// # Errors
    /// If there is no such setting.
    fn any_integer(&self, name: &'static str) -> Result<Option<u64>, Self::Error>;

    /// True or false.
    ///
    /// # Errors
    /// If there is no such setting.
    fn any_flag(&self, name: &'static str) -> Result<Option<bool>, Self::Error>;

    /// A string.
    ///
    /// # Errors
    /// If there is no such setting.
    fn any_text(&self, name: &'static str) -> Result<Option<String>, Self::Error>;

    /// The error for an invalid setting, which shows its value and the expected one.
    fn invalid(&self, name: &'static str, expected: &str) -> Self::Error;

    /// A number from `low` to `high`; `f64::MAX` is no limit, and [`ABOVE_ZERO`] excludes 0.
    ///
    /// # Errors
    /// If the setting is missing, or is not such a number.
    fn number(&self, name: &'static str, low: f64, high: f64) -> Result<f64, Self::Error> {
        let number = self.any_number(name)?.filter(|number| (low..=high).contains(number));
        number.ok_or_else(|| match (low, high) {
            (ABOVE_ZERO, f64::MAX) => self.invalid(name, "a finite number above 0"),
            (_, f64::MAX) => self.invalid(name, "a finite number that is not negative"),
            _ => self.invalid(name, &format!("a number in [{low}, {high}]")),
        })
    }

    /// An integer from `low` to `high`.
    ///
    /// # Errors
    /// If the setting is missing, or is not such an integer.
    fn integer(&self, name: &'static str, low: u64, high: u64) -> Result<u64, Self::Error> {
        let integer = self.any_integer(name)?.filter(|integer| (low..=high).contains(integer));
        integer.ok_or_else(|| self.invalid(name, &format!("an integer from {low} to {high}")))
    }

    /// True or false.
    ///
    /// # Errors
    /// If the setting is missing, or is neither.
    fn flag(&self, name: &'static str) -> Result<bool, Self::Error> {
        self.any_flag(name)?.ok_or_else(|| self.invalid(name, "true or false"))
    }

    /// The value that one of several words stands for.
    ///
    /// # Errors
    /// If the setting is missing, or is none of the words.
    fn word<T: Copy>(&self, name: &'static str, words: &[(&str, T)]) -> Result<T, Self::Error> {
        let given = self.any_text(name)?;
        let found = words.iter().find(|(word, _)| given.as_deref() == Some(word));
        found.map(|&(_, value)| value).ok_or_else(|| {
            let known: Vec<String> = words.iter().map(|(word, _)| format!("'{word}'")).collect();
            self.invalid(name, &known.join(" or "))
        })
    }
}
