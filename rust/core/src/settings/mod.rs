//! The settings of a learner by the names of `qtab.Config`, from whatever holds them: a dict of Python, or JSON.

mod algorithm;
mod policy;
mod schedule;

pub use algorithm::AlgorithmRows;
pub use policy::PolicySpec;
pub use schedule::{LearningRateSpec, SCHEDULES, ScheduleSpec};

/// The smallest number above 0, as a bound of [`SettingSource::number`].
pub(crate) const ABOVE_ZERO: f64 = f64::from_bits(1);

/// What holds settings. Each reader returns an error for a setting that is not there, and `None` for one of another type.
pub trait SettingSource {
    /// What is wrong with a setting.
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

    /// A text.
    ///
    /// # Errors
    /// If there is no such setting.
    fn any_text(&self, name: &'static str) -> Result<Option<String>, Self::Error>;

    /// The error of a setting that must be something else, which shows its value.
    fn invalid(&self, name: &'static str, expected: &str) -> Self::Error;

    /// A number from `low` to `high`; `f64::MAX` is no limit, and [`ABOVE_ZERO`] excludes 0.
    ///
    /// # Errors
    /// If the setting is not there, or is not such a number.
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
    /// If the setting is not there, or is not such an integer.
    fn integer(&self, name: &'static str, low: u64, high: u64) -> Result<u64, Self::Error> {
        let integer = self.any_integer(name)?.filter(|integer| (low..=high).contains(integer));
        integer.ok_or_else(|| self.invalid(name, &format!("an integer from {low} to {high}")))
    }

    /// True or false.
    ///
    /// # Errors
    /// If the setting is not there, or is neither.
    fn flag(&self, name: &'static str) -> Result<bool, Self::Error> {
        self.any_flag(name)?.ok_or_else(|| self.invalid(name, "true or false"))
    }

    /// One of some words: what it stands for.
    ///
    /// # Errors
    /// If the setting is not there, or is none of the words.
    fn word<T: Copy>(&self, name: &'static str, words: &[(&str, T)]) -> Result<T, Self::Error> {
        let given = self.any_text(name)?;
        let found = words.iter().find(|(word, _)| given.as_deref() == Some(word));
        found.map(|&(_, value)| value).ok_or_else(|| {
            let known: Vec<String> = words.iter().map(|(word, _)| format!("'{word}'")).collect();
            self.invalid(name, &known.join(" or "))
        })
    }
}
