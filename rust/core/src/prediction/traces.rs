//! Eligibility traces of state values, for TD(λ) and true online TD(λ).

/// The traces z of all weights, and the indices of those that may be nonzero.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct StateTraces {
    pub(super) values: Vec<f64>,
    eligible: Vec<u32>,
    is_eligible: Vec<bool>,
}

impl StateTraces {
    pub(super) fn new(weights: usize) -> Self {
        Self { values: vec![0.0; weights], eligible: Vec::with_capacity(weights), is_eligible: vec![false; weights] }
    }

    /// Adds to the trace of a weight.
    #[inline]
    pub(super) fn add(&mut self, row: u32, increment: f64) {
        if !std::mem::replace(&mut self.is_eligible[row as usize], true) {
            self.eligible.push(row);
        }
        self.values[row as usize] += increment;
    }

    /// Multiplies all traces by a factor.
    #[inline]
    pub(super) fn decay(&mut self, factor: f64) {
        for &row in &self.eligible {
            self.values[row as usize] *= factor;
        }
    }

    /// w ← w + step z.
    #[inline]
    pub(super) fn apply(&self, weights: &mut [f64], step: f64) {
        for &row in &self.eligible {
            weights[row as usize] += step * self.values[row as usize];
        }
    }

    /// z ← 0.
    pub(super) fn clear(&mut self) {
        for row in self.eligible.drain(..) {
            self.values[row as usize] = 0.0;
            self.is_eligible[row as usize] = false;
        }
    }

    /// The work of one pass over the traces.
    #[inline]
    pub(super) fn work(&self) -> u64 {
        1 + self.eligible.len() as u64 / 4
    }
}
