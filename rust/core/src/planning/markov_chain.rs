//! The Markov chain of a policy on a transition table, and its linear equations.

use crate::StopFlag;

use super::elimination::Eliminated;
use super::stop_checks::StopChecks;
use super::sweeps::converge;
use super::{MAX_SWEEPS, PlanningError};
use crate::envs::tabular::TabularMdp;
use crate::memory::{filled, reserve, with_capacity};

/// The number of sweeps before a direct method is used: most chains end, or are discounted, earlier.
const SWEEPS_BEFORE_ELIMINATION: u64 = 1000;
/// The largest number of states that a direct method solves for: a matrix of 32 MB, within seconds.
const MAX_ELIMINATED: usize = 2000;

/// The discounted probabilities of the next states, and the expected reward, of each state.
#[derive(Clone, Debug)]
pub(super) struct MarkovChain {
    /// The index of each state's first transition, followed by the number of transitions.
    starts: Vec<usize>,
    /// The next state of each transition, and its probability times the discount.
    transitions: Vec<(u32, f64)>,
    /// The expected reward of a step from each state.
    pub(super) rewards: Vec<f64>,
    /// The expected magnitude of the reward of a step from each state.
    reward_sizes: Vec<f64>,
    /// The number of outcomes of each state. Terminal outcomes have no transition.
    outcomes: Vec<u32>,
    /// Whether an episode can end with the step from each state.
    may_end: Vec<bool>,
}

impl MarkovChain {
    /// `choices` returns the actions that the policy takes in a state, with their probabilities.
    ///
    /// # Errors
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    pub(super) fn new<Choices: Iterator<Item = (usize, f64)>>(
        mdp: &TabularMdp,
        discount: f64,
        stop: &StopFlag<'_>,
        choices: impl Fn(usize) -> Choices,
    ) -> Result<Self, PlanningError> {
        let num_states = mdp.num_states();
        let mut chain = Self {
            starts: with_capacity(num_states + 1)?,
            transitions: Vec::new(),
            rewards: filled(&0.0, num_states, stop)?,
            reward_sizes: filled(&0.0, num_states, stop)?,
            outcomes: filled(&0, num_states, stop)?,
            may_end: filled(&false, num_states, stop)?,
        };
        let mut checks = StopChecks::new(mdp, stop);
        for state in 0..num_states {
            chain.starts.push(chain.transitions.len());
            for (action, chosen) in choices(state) {
                for (probability, step) in mdp.outcomes(state, action) {
                    let weight = chosen * probability;
                    chain.rewards[state] += weight * step.reward;
                    chain.reward_sizes[state] += (weight * step.reward).abs();
                    chain.outcomes[state] += 1;
                    if step.terminated {
                        chain.may_end[state] |= weight > 0.0;
                    } else if weight * discount > 0.0 {
                        reserve(&mut chain.transitions, 1)?;
                        chain.transitions.push((step.state, weight * discount));
                    }
                }
            }
            checks.state()?;
        }
        chain.starts.push(chain.transitions.len());
        Ok(chain)
    }

    /// The number of states.
    pub(super) fn num_states(&self) -> usize {
        self.rewards.len()
    }

    /// The next states of a state, and their probabilities times the discount.
    fn next(&self, state: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = self.starts[state]..self.starts[state + 1];
        self.transitions[range].iter().map(|&(next, weight)| (next as usize, weight))
    }

    /// The states that only lead to each other and collect no reward. Without discounting their value is 0.
    pub(super) fn staying(&self, stop: &StopFlag<'_>) -> Result<Vec<bool>, PlanningError> {
        let mut staying: Vec<bool> = with_capacity(self.num_states())?;
        staying.extend(self.reward_sizes.iter().map(|&size| size == 0.0));
        self.checks(stop).until_stable(self.num_states(), |state| {
            let leaves = staying[state] && self.next(state).any(|(next, _)| !staying[next]);
            staying[state] &= !leaves;
            leaves
        })?;
        Ok(staying)
    }

    /// The states from which an episode can end, or reach one of `goals`.
    pub(super) fn reaching(&self, goals: &[bool], stop: &StopFlag<'_>) -> Result<Vec<bool>, PlanningError> {
        let mut reaching: Vec<bool> = with_capacity(self.num_states())?;
        reaching.extend(goals.iter().zip(&self.may_end).map(|(&goal, &ends)| goal || ends));
        self.checks(stop).until_stable(self.num_states(), |state| {
            let found = !reaching[state] && self.next(state).any(|(next, _)| reaching[next]);
            reaching[state] |= found;
            found
        })?;
        Ok(reaching)
    }

    /// The states that are reachable from a distribution, each after one that leads to it.
    pub(super) fn reachable(&self, initial: &[f64], stop: &StopFlag<'_>) -> Result<Vec<usize>, PlanningError> {
        let mut checks = self.checks(stop);
        let mut reached = filled(&false, self.num_states(), stop)?;
        let mut states = with_capacity(self.num_states())?;
        for (state, &probability) in initial.iter().enumerate() {
            if probability > 0.0 {
                reached[state] = true;
                states.push(state);
            }
        }
        let mut visited = 0;
        while let Some(&state) = states.get(visited) {
            for (next, _) in self.next(state) {
                if !reached[next] {
                    reached[next] = true;
                    states.push(next);
                }
            }
            visited += 1;
            checks.state()?;
        }
        Ok(states)
    }

    /// The transitions reversed, without any other data.
    pub(super) fn transposed(&self, stop: &StopFlag<'_>) -> Result<Self, PlanningError> {
        let num_states = self.num_states();
        let mut starts = filled(&0, num_states + 1, stop)?;
        for &(next, _) in &self.transitions {
            starts[next as usize + 1] += 1;
        }
        for state in 0..num_states {
            starts[state + 1] += starts[state];
        }
        let mut places = filled(&0, num_states, stop)?;
        places.copy_from_slice(&starts[..num_states]);
        let mut transitions = filled(&(0, 0.0), self.transitions.len(), stop)?;
        for state in 0..num_states {
            for (next, weight) in self.next(state) {
                transitions[places[next]] = (state as u32, weight);
                places[next] += 1;
            }
        }
        let zeros = || filled(&0.0, num_states, stop);
        Ok(Self {
            starts,
            transitions,
            rewards: zeros()?,
            reward_sizes: zeros()?,
            outcomes: filled(&0, num_states, stop)?,
            may_end: filled(&false, num_states, stop)?,
        })
    }

    /// c(s) + Σ γ p x(s′), summed from left to right, and the sum of the magnitudes of its terms.
    fn sum(&self, state: usize, constant: f64, values: &[f64]) -> (f64, f64) {
        self.next(state).fold((constant, constant.abs()), |(sum, size), (next, weight)| {
            let term = weight * values[next];
            (sum + term, size + term.abs())
        })
    }

    fn checks<'a>(&self, stop: &'a StopFlag<'a>) -> StopChecks<'a> {
        StopChecks::with_outcomes(self.transitions.len(), self.num_states(), stop)
    }
}

/// The linear equations x(s) = c(s) + Σ γ p x(s′) for some states of a chain, for any constants c.
pub(super) struct Equations<'a> {
    chain: &'a MarkovChain,
    unknown: Vec<usize>,
    /// The eliminated equations, once sweeps took long, and the index of each state among the unknown ones;
    /// `usize::MAX` for the others.
    eliminated: Option<(Eliminated, Vec<usize>)>,
}

impl<'a> Equations<'a> {
    /// The equations of the states in `unknown`.
    pub(super) fn new(chain: &'a MarkovChain, unknown: Vec<usize>) -> Self {
        Self { chain, unknown, eliminated: None }
    }

    /// Solves the equations. `solution` holds an initial guess, and the values of the other states, which stay fixed.
    ///
    /// # Errors
    /// `NotConverged` if there are too many states for a direct method, or the equations are singular to rounding;
    /// `Overflow`;
    /// `OutOfMemory`; `Stopped` after `stop` was set.
    pub(super) fn solve(
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
    pub(super) fn errors(&mut self, values: &[f64], stop: &StopFlag<'_>) -> Result<Vec<f64>, PlanningError> {
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
