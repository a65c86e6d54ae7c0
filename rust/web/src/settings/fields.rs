//! Typed access to the settings. Errors name the setting as Python spells it.

use std::cell::RefCell;

use qtab_core::settings::SettingSource;
use serde_json::{Map, Value};

use crate::failure::Failure;
use crate::json::{integer, numbers, shown};

/// The settings of a request, and the names of those that were read.
pub(crate) struct Fields<'a> {
    settings: &'a Map<String, Value>,
    used: RefCell<Vec<&'static str>>,
}

impl<'a> Fields<'a> {
    pub(crate) fn new(settings: &'a Value) -> Result<Self, Failure> {
        match settings {
            Value::Object(settings) => Ok(Self { settings, used: RefCell::default() }),
            _ => Err("settings must be an object".into()),
        }
    }

    fn find(&self, name: &'static str) -> Option<&'a Value> {
        self.used.borrow_mut().push(name);
        self.settings.get(name)
    }

    /// A setting, whatever its type.
    pub(crate) fn any(&self, name: &'static str) -> Result<&'a Value, Failure> {
        let message = || Failure { setting: Some(name.into()), message: format!("{name} must be given") };
        self.find(name).ok_or_else(message)
    }

    /// A number for each of `count` components, if given.
    pub(crate) fn numbers(&self, name: &'static str, count: usize) -> Result<Option<Vec<f64>>, Failure> {
        let Some(given) = self.find(name) else { return Ok(None) };
        match numbers(given) {
            Some(numbers) if numbers.len() == count => Ok(Some(numbers)),
            _ => Err(self.invalid(name, &format!("an array of {count} finite numbers"))),
        }
    }

    /// An integer for each of `count` components, given as an array or as one number for all.
    pub(crate) fn integers(&self, name: &'static str, count: usize, high: u32) -> Result<Vec<u32>, Failure> {
        let given = self.any(name)?;
        let given = given.as_array().map_or(std::slice::from_ref(given), Vec::as_slice);
        let integers: Option<Vec<u32>> = given.iter().map(|given| integer(given, high)).collect();
        match integers {
            Some(integers) if integers.contains(&0) => {}
            Some(integers) if integers.len() == count => return Ok(integers),
            Some(integers) if integers.len() == 1 => return Ok(vec![integers[0]; count]),
            _ => {}
        }
        Err(self.invalid(name, &format!("{count} integers from 1 to {high}, or one for all")))
    }

    /// Rejects settings that were not read: they do not apply, or do not exist.
    pub(crate) fn check_all_used(&self) -> Result<(), Failure> {
        let used = self.used.borrow();
        let unused = self.settings.keys().find(|name| !used.contains(&name.as_str()));
        let Some(name) = unused else { return Ok(()) };
        let name: String = name.chars().take(40).collect();
        Err(Failure { message: format!("{name} does not apply to these settings"), setting: Some(name) })
    }
}

impl SettingSource for Fields<'_> {
    type Error = Failure;

    fn has(&self, name: &str) -> bool {
        self.settings.contains_key(name)
    }

    fn any_number(&self, name: &'static str) -> Result<Option<f64>, Failure> {
        self.any(name).map(Value::as_f64)
    }

    fn any_integer(&self, name: &'static str) -> Result<Option<u64>, Failure> {
        self.any(name).map(Value::as_u64)
    }

    fn any_flag(&self, name: &'static str) -> Result<Option<bool>, Failure> {
        self.any(name).map(Value::as_bool)
    }

    fn any_text(&self, name: &'static str) -> Result<Option<String>, Failure> {
        self.any(name).map(|text| text.as_str().map(String::from))
    }

    fn invalid(&self, name: &'static str, expected: &str) -> Failure {
        let got = self.find(name).map_or_else(|| "nothing".into(), shown);
        Failure { setting: Some(name.into()), message: format!("{name} must be {expected}, got {got}") }
    }
}
