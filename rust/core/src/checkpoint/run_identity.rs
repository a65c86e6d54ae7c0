//! What a run is made of, so that a checkpoint is not restored into another run.

use std::any::type_name;
use std::fmt::Display;

use super::{Checkpoint, CheckpointError, Persist};

/// What a run is made of: names with values, such as the learner, the number of rows and the seed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RunIdentity(Vec<(String, String)>);

impl RunIdentity {
    /// Adds a part.
    pub fn add(&mut self, name: &str, value: impl Display) {
        self.0.push((name.to_owned(), value.to_string()));
    }

    /// Adds the name of a type, without the paths of its modules, as this compiler writes it.
    pub fn add_type<T: ?Sized>(&mut self, name: &str) {
        self.add(name, without_paths(type_name::<T>()));
    }

    /// The first part that differs: its name, its value in `self` and its value in `other`.
    pub(crate) fn difference(&self, other: &Self) -> Option<(String, String, String)> {
        let value = |parts: &Self, name: &str, index: usize| {
            let mut same = parts.0.iter().filter(|(other, _)| other == name);
            same.nth(index).map_or_else(|| "none".to_owned(), |(_, value)| value.clone())
        };
        let names = self.0.iter().chain(&other.0).map(|(name, _)| name);
        names.into_iter().find_map(|name| {
            let count = |parts: &Self| parts.0.iter().filter(|(other, _)| other == name).count();
            (0..count(self).max(count(other))).find_map(|index| {
                let (ours, theirs) = (value(self, name, index), value(other, name, index));
                (ours != theirs).then(|| (name.clone(), ours, theirs))
            })
        })
    }
}

impl Persist for RunIdentity {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        let mut text: Vec<u8> =
            self.0.iter().flat_map(|(name, value)| format!("{name}\0{value}\0").into_bytes()).collect();
        checkpoint.values(&mut text)?;
        if checkpoint.is_restoring() {
            let text = String::from_utf8(text).map_err(|_| CheckpointError::Invalid("description of the run"))?;
            let words: Vec<&str> = text.split_terminator('\0').collect();
            let pairs = words.as_chunks::<2>().0;
            self.0 = pairs.iter().map(|[name, value]| ((*name).to_owned(), (*value).to_owned())).collect();
        }
        Ok(())
    }
}

/// The name of a type without the paths of its modules.
fn without_paths(name: &str) -> String {
    let mut short = String::new();
    let mut word = 0;
    for letter in name.chars() {
        short.push(letter);
        if letter == ':' {
            short.truncate(word);
        } else if !letter.is_alphanumeric() && letter != '_' {
            word = short.len();
        }
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_difference_is_named() {
        let identity = |seed: u64, rows: Option<u32>| {
            let mut identity = RunIdentity::default();
            identity.add("seed", seed);
            if let Some(rows) = rows {
                identity.add("rows", rows);
            }
            identity
        };
        let difference = |other: &RunIdentity| identity(1, Some(9)).difference(other);
        let parts = |name: &str, ours: &str, theirs: &str| Some((name.to_owned(), ours.to_owned(), theirs.to_owned()));
        assert_eq!(difference(&identity(1, Some(9))), None);
        assert_eq!(difference(&identity(2, None)), parts("seed", "1", "2"));
        assert_eq!(difference(&identity(1, None)), parts("rows", "9", "none"));
        assert_eq!(identity(1, None).difference(&identity(1, Some(9))), parts("rows", "none", "9"));
    }

    #[test]
    fn types_have_short_names() {
        assert_eq!(without_paths("a::b::C<[u32; 1], d::E_f<0>>"), "C<[u32; 1], E_f<0>>");
    }

    #[test]
    fn an_identity_is_restored() {
        let (mut saved, mut bytes, mut restored) = (RunIdentity::default(), Vec::new(), RunIdentity::default());
        saved.add("map", "");
        saved.add_type::<RunIdentity>("type");
        saved.persist(&mut Checkpoint::save(&mut bytes)).expect("memory suffices");
        restored.persist(&mut Checkpoint::restore(&bytes)).expect("the bytes are complete");
        assert_eq!(restored, saved);
    }
}
