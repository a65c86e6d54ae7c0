//! A policy that is a function in Python: from an observation to an action, or to the probabilities of all.

use std::sync::Arc;

use pyo3::prelude::*;
use qtab_core::random::Rng;

use super::observation_policy::{FunctionSpec, integer};

/// The function, and what it answered for the observation that it read last.
pub(crate) struct FunctionPolicy {
    spec: Arc<FunctionSpec>,
    answer: PolicyAnswer,
    /// The probabilities of the actions, where it answered with these.
    probabilities: Vec<f64>,
}

enum PolicyAnswer {
    Action(usize),
    Probabilities,
}

impl FunctionPolicy {
    pub(super) fn new(spec: Arc<FunctionSpec>, num_actions: usize) -> Self {
        Self { spec, answer: PolicyAnswer::Action(0), probabilities: vec![0.0; num_actions] }
    }

    /// Asks the function.
    pub(super) fn read(&mut self, observation: &Bound<'_, PyAny>) -> PyResult<()> {
        let py = observation.py();
        let answer = self.spec.function.bind(py).call1((observation,))?;
        let column = integer(&answer).and_then(|number| number.checked_sub(self.spec.first_action));
        if let Some(column) = column.and_then(|column| usize::try_from(column).ok())
            && column < self.probabilities.len()
        {
            self.answer = PolicyAnswer::Action(column);
            return Ok(());
        }
        // Whatever is no valid number is read, or refused, in Python.
        let read: Vec<f64> = self.spec.read.bind(py).call1((answer, observation))?.extract()?;
        self.probabilities.copy_from_slice(&read);
        self.answer = PolicyAnswer::Probabilities;
        Ok(())
    }

    /// The action; or the first one whose sum of probabilities exceeds one `random()`.
    pub(super) fn sample(&self, rng: &mut impl Rng) -> usize {
        if let PolicyAnswer::Action(action) = self.answer {
            return action;
        }
        let (random, mut sum) = (rng.random(), 0.0);
        let mut last = 0;
        for (action, &probability) in self.probabilities.iter().enumerate() {
            if probability > 0.0 {
                sum += probability;
                last = action;
                if random < sum {
                    break;
                }
            }
        }
        last
    }

    pub(super) fn probability(&self, action: usize) -> f64 {
        match self.answer {
            PolicyAnswer::Action(chosen) => f64::from(u8::from(action == chosen)),
            PolicyAnswer::Probabilities => self.probabilities[action],
        }
    }
}
