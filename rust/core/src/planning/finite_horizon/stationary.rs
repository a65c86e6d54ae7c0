//! The best known policy under a time limit that does not depend on the number of steps taken.

use super::backward_induction::finite_horizon;
use super::policy_return::{policy_return, return_error};
use crate::StopFlag;
use crate::envs::Env;
use crate::memory::filled;
use crate::planning::{Mdp, PlanningError};

/// The discounts whose policies are tried.
const DISCOUNTS: [f64; 15] =
    [1.0, 0.9999, 0.9995, 0.999, 0.998, 0.995, 0.99, 0.98, 0.97, 0.95, 0.9, 0.8, 0.7, 0.5, 0.2];
/// The number of sweeps of backward induction per step of the time limit; fewer if these take too long.
const SWEEPS_PER_STEP: u64 = 4;
const LEAST_SWEEPS: u64 = 100;
/// Tables with more state-action pairs times steps are not searched.
const MAX_PAIR_UPDATES: u64 = 20_000_000;
/// The number of outcomes that backward induction may read, and then the changes of single actions: less than a second
/// each.
const MAX_UPDATES: u64 = 50_000_000;
/// A change of a single action must improve the return by more than this fraction of it.
const TOLERANCE: f64 = 1e-12;

/// A policy that does not depend on the number of steps taken, and its return under the time limit.
#[derive(Clone, Debug, PartialEq)]
pub struct StationaryPolicy {
    /// The action in each row of the agent's table.
    pub policy: Vec<usize>,
    /// Its undiscounted expected return.
    pub expected_return: f64,
    /// Whether no policy at all has a larger return.
    pub proven: bool,
}

/// Searches for the stationary policy with the largest undiscounted return within `steps` steps; `None` if the table is
/// too large to be searched within seconds.
///
/// The search compares the policies of several discounts, then improves the best one by changing the action of one row
/// at a time until no change helps. `num_rows` is the number of rows, which the first states show.
///
/// # Errors
/// `Overflow`; `OutOfMemory`; `Stopped` after `stop` was set.
pub fn stationary_policy(
    mdp: &Mdp,
    num_rows: usize,
    steps: u64,
    stop: &StopFlag<'_>,
) -> Result<Option<StationaryPolicy>, PlanningError> {
    let Mdp { table, rows } = mdp;
    let (num_outcomes, num_actions) = (table.num_outcomes() as u64, table.num_actions() as u64);
    if (rows.len() as u64 * num_actions).saturating_mul(steps) > MAX_PAIR_UPDATES {
        return Ok(None);
    }
    let most = MAX_UPDATES / (DISCOUNTS.len() as u64 * num_outcomes);
    let sweeps = (SWEEPS_PER_STEP * steps).max(LEAST_SWEEPS).min(most);
    if sweeps < LEAST_SWEEPS {
        return Ok(None);
    }
    let optimal = finite_horizon(table, 1.0, steps, stop)?.expected_return;
    let mut search = Search { mdp, steps, by_state: filled(&0, rows.len(), stop)?, stop };
    let mut best = Candidate { policy: filled(&0, num_rows, stop)?, expected_return: f64::NEG_INFINITY, error: 0.0 };
    for discount in DISCOUNTS {
        let mut policy = finite_horizon(table, discount, sweeps, stop)?.policy;
        policy.truncate(num_rows);
        let expected_return = search.expected_return(&policy)?;
        if expected_return > best.expected_return {
            best = Candidate { policy, expected_return, error: search.error()? };
        }
        if best.reaches(optimal) {
            break;
        }
    }
    if !best.reaches(optimal) {
        search.improve(&mut best, table.num_actions(), MAX_UPDATES * num_actions / (num_outcomes * steps))?;
    }
    let proven = best.reaches(optimal);
    Ok(Some(StationaryPolicy { policy: best.policy, expected_return: best.expected_return, proven }))
}

struct Candidate {
    policy: Vec<usize>,
    expected_return: f64,
    /// The rounding error that the return may have.
    error: f64,
}

impl Candidate {
    fn reaches(&self, optimal: f64) -> bool {
        // The optimal return has at most about the same error.
        (optimal - self.expected_return).abs() <= (2.0 * self.error).max(TOLERANCE * optimal.abs())
    }
}

struct Search<'a> {
    mdp: &'a Mdp,
    steps: u64,
    /// The action of each state under the policy being evaluated.
    by_state: Vec<usize>,
    stop: &'a StopFlag<'a>,
}

impl Search<'_> {
    fn expected_return(&mut self, policy: &[usize]) -> Result<f64, PlanningError> {
        self.by_state.iter_mut().zip(&self.mdp.rows).for_each(|(action, &row)| *action = policy[row]);
        policy_return(&self.mdp.table, &self.by_state, self.steps, self.stop)
    }

    /// A bound of the rounding error of the return that was evaluated last.
    fn error(&self) -> Result<f64, PlanningError> {
        return_error(&self.mdp.table, &self.by_state, self.steps, self.stop)
    }

    /// Makes every change of a single action that helps, in turn, until none helps or `most` were tried.
    fn improve(&mut self, best: &mut Candidate, num_actions: usize, mut most: u64) -> Result<(), PlanningError> {
        let (mut row, mut unchanged) = (0, 0);
        while unchanged < best.policy.len() {
            unchanged += 1;
            for action in 0..num_actions {
                let kept = best.policy[row];
                if action == kept {
                    continue;
                }
                if most == 0 {
                    return Ok(());
                }
                most -= 1;
                best.policy[row] = action;
                let changed = self.expected_return(&best.policy)?;
                if changed > best.expected_return + TOLERANCE * best.expected_return.abs() {
                    (best.expected_return, best.error, unchanged) = (changed, self.error()?, 0);
                } else {
                    best.policy[row] = kept;
                }
            }
            row = (row + 1) % best.policy.len();
        }
        Ok(())
    }
}
