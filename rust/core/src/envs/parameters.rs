//! The trait of environments with named parameters.

/// A parameter with two values, such as Gymnasium's `kinematics_integrator`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Flag {
    /// The name of Gymnasium's attribute.
    pub name: &'static str,
    /// The string that means true; `None` if the attribute is a bool.
    pub true_value: Option<&'static str>,
}

/// Access to the parameters of an environment by the names of Gymnasium's attributes.
pub trait Parameters: Default {
    /// The names of the numeric parameters.
    const NAMES: &'static [&'static str];
    /// The parameters with two values.
    const FLAGS: &'static [Flag] = &[];

    /// The numeric parameter of that name.
    fn parameter(&mut self, name: &str) -> Option<&mut f64>;

    /// The flag of that name.
    fn flag(&mut self, _name: &str) -> Option<&mut bool> {
        None
    }
}

/// Defines the numeric parameters of [`Parameters`]: fields of these names, or a name for each field.
macro_rules! parameters {
    ($($field:ident),+) => {
        parameters!($(stringify!($field) => $field),+);
    };
    ($($name:expr => $field:ident),+ $(,)?) => {
        const NAMES: &'static [&'static str] = &[$($name),+];

        fn parameter(&mut self, name: &str) -> Option<&mut f64> {
            $(if name == $name {
                return Some(&mut self.$field);
            })+
            None
        }
    };
}

pub(in crate::envs) use parameters;
