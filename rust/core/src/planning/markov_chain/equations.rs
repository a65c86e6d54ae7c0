//! Linear equations of a Markov chain.

use super::MarkovChain;
use super::elimination::Eliminated;
use crate::StopFlag;
use crate::memory::{filled, with_capacity};
use crate::planning::sweeps::converge;
use crate::planning::{MAX_SWEEPS, PlanningError};

/// The number of sweeps before a direct method is used: most chains end, or are discounted, earlier.
const SWEEPS_BEFORE_ELIMINATION: u64 = 1000;

/// The largest number of states that a direct method solves for: a matrix of 32 MB, within seconds.
const MAX_ELIMINATED: usize = 2000;

/// The linear equations x(s) = c(s) + Σ γ p x(s′) for some states of a chain, for any constants c.
pub(in crate::planning) struct Equations<'a> {
    chain: &'a MarkovChain,
    unknown: Vec<usize>,
    /// The eliminated equations, once sweeps took long, and the index of each state among the unknown ones;
    /// `usize::MAX` for the others.
    eliminated: Option<(Eliminated, Vec<usize>)>,
}

impl<'a> Equations<'a> {
    /// The equations of the states in `unknown`.
    pub(in crate::planning) fn new(chain: &'a MarkovChain, unknown: Vec<usize>) -> Self {
        Self { chain, unknown, eliminated: None }
    }

    /// Solves the equations. `solution` holds an initial guess, and the values of the other states, which stay fixed.
    ///
    /// # Errors
    /// `NotConverged` if there are too many states for a direct method, or the equations are singular to rounding;
    /// `Overflow`; `OutOfMemory`; `Stopped` after `stop` was set.
    pub(in crate::planning) fn solve(
        &mut self,
        constants: &[f64],
        solution: &mut [f64],
        stop: &StopFlag<'_>,
    ) -> Result<(), PlanningError> {
        if self.eliminated.is_none() {
            let (unknown, chain) = (&self.unknown, self.chain);
            let count = unknown.len();
            let most = if count <= MAX_ELIMINATED { SWEEPS_BEFORE_ELIMINATION } else { MAX_SWEEPS };
            // Backwards and forwards: a corridor is solved at once, in whichever direction its states are numbered.
            let order = |sweep, index| unknown[if sweep % 2 == 1 { count - 1 - index } else { index }];
            let sum = |state: usize, values: &[f64]| chain.sum(state, constants[state], values);
            if converge(solution, count, most, chain.checks(stop), order, sum)? {
                return Ok(());
            }
            let not_converged = PlanningError::NotConverged { sweeps: most };
            if count > MAX_ELIMINATED {
                return Err(not_converged);
            }
            self.eliminated = Some(self.eliminate(stop)?.ok_or(not_converged)?);
        }
        let Some((eliminated, places)) = &self.eliminated else { return Ok(()) };
        let mut sides = with_capacity(self.unknown.len())?;
        sides.extend(self.unknown.iter().map(|&state| {
            let known = self.chain.next(state).filter(|&(next, _)| places[next] == usize::MAX);
            known.fold(constants[state], |side, (next, weight)| side + weight * solution[next])
        }));
        eliminated.solve(&mut sides);
        for (&state, &value) in self.unknown.iter().zip(&sides) {
            if !value.is_finite() {
                return Err(PlanningError::Overflow(state));
            }
            solution[state] = value;
        }
        Ok(())
    }

    fn eliminate(&self, stop: &StopFlag<'_>) -> Result<Option<(Eliminated, Vec<usize>)>, PlanningError> {
        let count = self.unknown.len();
        let mut places = filled(&usize::MAX, self.chain.num_states(), stop)?;
        for (place, &state) in self.unknown.iter().enumerate() {
            places[state] = place;
        }
        let mut matrix = filled(&0.0, count * count, stop)?;
        for (row, &state) in matrix.chunks_mut(count).zip(&self.unknown) {
            row[places[state]] = 1.0;
            for (next, weight) in self.chain.next(state) {
                if let Some(entry) = row.get_mut(places[next]) {
                    *entry -= weight;
                }
            }
        }
        Ok(Eliminated::new(matrix, count, stop)?.map(|eliminated| (eliminated, places)))
    }

    /// A bound on the error of each value: the expected sum, over the following states, of the residuals of the
    /// equations and of their rounding errors.
    pub(in crate::planning) fn errors(
        &mut self,
        values: &[f64],
        stop: &StopFlag<'_>,
    ) -> Result<Vec<f64>, PlanningError> {
        let chain = self.chain;
        let mut residuals = filled(&0.0, chain.num_states(), stop)?;
        for &state in &self.unknown {
            let (value, size) = chain.sum(state, chain.rewards[state], values);
            let terms = 2.0 + f64::from(chain.outcomes[state]);
            let size = (size + chain.reward_sizes[state] + values[state].abs()).clamp(f64::MIN_POSITIVE, f64::MAX);
            residuals[state] = (value - values[state]).abs() + f64::EPSILON * terms * size;
        }
        let mut errors = filled(&0.0, chain.num_states(), stop)?;
        self.solve(&residuals, &mut errors, stop)?;
        Ok(errors)
    }
}
