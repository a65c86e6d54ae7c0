//! The constants of an environment by name.

/// A constant that is one thing or the other, under Gymnasium's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Flag {
    /// The name, as Gymnasium spells the attribute.
    pub name: &'static str,
    /// The word that turns it on; None where the attribute is a truth value.
    pub true_value: Option<&'static str>,
}

/// The constants of an environment by Gymnasium's names, for those who know them at run time only.
pub trait Parameters: Default {
    /// The names of the numbers, as Gymnasium spells its attributes.
    const NAMES: &'static [&'static str];
    /// What is no number.
    const FLAGS: &'static [Flag] = &[];

    /// The number of that name.
    fn parameter(&mut self, name: &str) -> Option<&mut f64>;

    /// The switch of that name.
    fn flag(&mut self, _name: &str) -> Option<&mut bool> {
        None
    }
}
