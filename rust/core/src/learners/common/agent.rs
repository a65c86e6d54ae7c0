//! The parts that all learners share: the Q table, the policy and the constants of an update.

use super::ActionMasks;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::features::{ActiveFeatures, assert_binary};
use crate::policies::{AnyPolicy, Policy, assert_takes, random_available_action};
use crate::q_table::{QTable, TerminalUpdate};
use crate::random::Rng;
use crate::schedules::{LearningRate, StepSize};
use crate::tasks::Next;

/// The number of values of a row, traces or rewards of a return that are read per unit of work.
pub(crate) const VALUES_PER_WORK: u64 = 16;

/// The most work that a learner does in one call. A step that takes more work is left unfinished.
pub(crate) const MAX_WORK_PER_CALL: u64 = 8192;

/// The work of an update that reads a row of this many values.
#[inline]
pub(in crate::learners) fn row_work(num_actions: usize) -> u64 {
    1 + num_actions as u64 / VALUES_PER_WORK
}

/// A table, a policy and the constants of an update.
#[derive(Clone, Debug, PartialEq)]
pub struct Agent<const N: usize = 0, P = AnyPolicy, A = LearningRate> {
    /// The Q table.
    pub table: QTable<N>,
    /// The behaviour policy.
    pub policy: P,
    /// The learning rate α. A [`LearningRate`] divides itself by the number of active rows that it was made with. A plain
    /// `f64` and a [`Schedule`](crate::schedules::Schedule) are the step size of each active row as they are: with tile
    /// coding, divide them by the number of tilings, because larger step sizes diverge.
    pub learning_rate: A,
    /// The discount γ.
    pub discount: f64,
    /// The update at a terminal state.
    pub terminal_update: TerminalUpdate,
    /// The action masks; `None` if every action is available in every state. Ignored with `N` > 0.
    pub masks: Option<Box<ActionMasks>>,
}

/// Agents of any algorithm.
impl Agent {
    /// An agent with the discount γ, all actions in every state, and the value zero for terminal states.
    pub fn new(table: QTable, policy: AnyPolicy, learning_rate: LearningRate, discount: f64) -> Self {
        Self { table, policy, learning_rate, discount, terminal_update: TerminalUpdate::Target, masks: None }
    }
}

impl<const N: usize, P: Policy, A: StepSize> Agent<N, P, A> {
    /// Samples an action from the policy in the state with these active rows.
    ///
    /// # Panics
    /// With a policy that counts its choices, for weighted features.
    #[expect(clippy::inline_always, reason = "a call per step would take a tenth of its time")]
    #[inline(always)]
    pub fn choose(&mut self, rows: impl ActiveFeatures, rng: &mut impl Rng) -> usize {
        assert_takes(&self.policy, &rows);
        let values = masked_values::<N>(&mut self.masks, rows.as_ref(), self.table.action_values(&rows));
        self.policy.choose_in(rows.as_ref(), values, rng)
    }

    /// The action values of the state with these active rows. The value of an unavailable action is -∞.
    #[expect(clippy::inline_always, reason = "a call per step would take a tenth of its time")]
    #[inline(always)]
    pub fn action_values(&mut self, rows: impl ActiveFeatures) -> &[f64] {
        masked_values::<N>(&mut self.masks, rows.as_ref(), self.table.action_values(&rows))
    }

    /// The expected value Σₐ π(a) Q(a) of the state with these active rows.
    ///
    /// # Panics
    /// As [`choose`](Self::choose).
    #[expect(clippy::inline_always, reason = "a call per step would take a tenth of its time")]
    #[inline(always)]
    pub fn expected_value(&mut self, rows: impl ActiveFeatures) -> f64 {
        assert_takes(&self.policy, &rows);
        let values = masked_values::<N>(&mut self.masks, rows.as_ref(), self.table.action_values(&rows));
        self.policy.expected_value_in(rows.as_ref(), values)
    }

    /// The probability π(a) of an action in the state with these active rows.
    pub fn probability(&mut self, rows: impl ActiveFeatures, action: usize) -> f64 {
        let values = masked_values::<N>(&mut self.masks, rows.as_ref(), self.table.action_values(&rows));
        self.policy.probability(values, action)
    }

    /// A random available action in the state with these active rows, drawn by `rng.integers`.
    #[inline]
    pub fn sample_action(&mut self, rows: impl ActiveFeatures, rng: &mut impl Rng) -> usize {
        match &self.masks {
            None => rng.integers(self.table.num_actions() as u32) as usize,
            Some(_) => self.sample_available_action(rows, rng),
        }
    }

    /// A random available action. It is a separate function, so that the case without masks is inlined, and marked as cold,
    /// so that this case keeps its registers: otherwise Dyna-Q+ takes 2 % more instructions.
    #[cold]
    fn sample_available_action(&mut self, rows: impl ActiveFeatures, rng: &mut impl Rng) -> usize {
        random_available_action(self.action_values(rows), rng)
    }

    /// Records the action mask of a state.
    ///
    /// # Panics
    /// With masks for weighted features.
    #[inline]
    pub fn set_action_mask<R: ActiveFeatures>(&mut self, rows: R, mask: &[bool]) {
        if let Some(masks) = &mut self.masks {
            assert_binary::<R>();
            masks.set(rows.as_ref(), mask);
        }
    }

    /// The action masks, row by row; `None` if every action is available in every state.
    pub fn action_masks(&self) -> Option<&[bool]> {
        self.masks.as_deref().map(ActionMasks::available)
    }

    /// Samples A′ in the next state S′ and returns both; `None` if S′ is terminal. If the episode is truncated, A′ is
    /// sampled for its value Q(S′, A′) and never taken.
    #[expect(clippy::inline_always, reason = "a call per step would take a tenth of its time")]
    #[inline(always)]
    pub fn sample_next<R: Copy + ActiveFeatures>(&mut self, next: Next<R>, rng: &mut impl Rng) -> Option<(R, usize)> {
        match next {
            Next::NonTerminal(next_state) | Next::Truncated(next_state) => {
                Some((next_state, self.choose(next_state, rng)))
            }
            Next::Terminal => None,
        }
    }

    /// Samples the next action, for update rules that do not need it. At the end of an episode it draws nothing and
    /// returns 0.
    #[expect(clippy::inline_always, reason = "a call per step would take a tenth of its time")]
    #[inline(always)]
    pub fn next_action<R: Copy + ActiveFeatures>(&mut self, next: Next<R>, rng: &mut impl Rng) -> usize {
        if let Next::NonTerminal(next_state) = next { self.choose(next_state, rng) } else { 0 }
    }

    /// Q(S, A).
    #[inline]
    pub fn value(&self, rows: impl ActiveFeatures, action: usize) -> f64 {
        self.table.value(&rows, action)
    }

    /// Counts a visit to a state-action pair. Weighted features have no visits: they are active in every state.
    #[inline]
    pub fn visit<R: ActiveFeatures>(&mut self, rows: R, action: usize) {
        if R::WEIGHTED || self.learning_rate.uniform().is_some() {
            return;
        }
        for &row in rows.as_ref() {
            self.learning_rate.visit(self.table.weight_index(row, action));
        }
    }

    /// Q(S, A) ← Q(S, A) + α [target - Q(S, A)].
    #[inline]
    pub fn update(&mut self, rows: impl ActiveFeatures, action: usize, target: f64) {
        self.table.update(&rows, action, target, &mut self.learning_rate);
    }

    /// The update for a terminal S′, according to `terminal_update`.
    #[inline]
    pub fn update_terminal(&mut self, rows: impl ActiveFeatures, action: usize, reward: f64) {
        self.table.update_terminal(&rows, action, reward, self.terminal_update, &mut self.learning_rate);
    }

    /// The work of an update: 1 with a few actions, more if reading a row takes longer. A number of actions known to
    /// the compiler is always small.
    #[inline]
    pub fn work(&self) -> u64 {
        if N > 0 { 1 } else { row_work(self.table.num_actions()) }
    }

    /// [`work`](Self::work) with active rows `R`: weighted features read the whole table.
    #[inline]
    pub(in crate::learners) fn work_of<R: ActiveFeatures>(&self) -> u64 {
        if R::WEIGHTED { row_work(self.table.values().len()) } else { self.work() }
    }

    /// Saves or restores the counts of the learning rate and the action masks.
    pub(crate) fn persist_counts(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        if let Some(masks) = &mut self.masks {
            masks.persist(checkpoint)?;
        }
        self.learning_rate.persist_counts(checkpoint)?;
        self.policy.persist_counts(checkpoint)
    }

    /// Moves the schedules on to the next episode.
    #[inline]
    pub fn end_episode(&mut self) {
        self.policy.end_episode();
        self.learning_rate.end_episode();
    }
}

/// Action values, with -∞ for the actions that are not available in the state with these active rows.
#[expect(clippy::inline_always, reason = "a call per step would take a tenth of its time")]
#[inline(always)]
pub(in crate::learners) fn masked_values<'a, const N: usize>(
    masks: &'a mut Option<Box<ActionMasks>>,
    rows: &[u32],
    values: &'a [f64],
) -> &'a [f64] {
    match masks {
        Some(masks) if N == 0 => masks.masked(rows, values),
        _ => values,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::StopFlag;
    use crate::learners::test_support::{agent, features, rng};
    use crate::policies::{TieBreaking, Ucb};

    #[test]
    #[should_panic(expected = "needs binary features")]
    fn ucb_does_not_count_choices_with_weighted_features() {
        let mut agent = agent(&[0.0; 4]);
        let ucb = Ucb::new(2.0, TieBreaking::First, (2, 2), &StopFlag::new()).expect("a few counts");
        agent.policy = AnyPolicy::Ucb(ucb);
        assert_eq!(agent.choose([0], &mut rng()), 0);
        agent.choose(features(), &mut rng());
    }

    #[test]
    #[should_panic(expected = "needs binary features")]
    fn weighted_features_have_no_action_masks() {
        let mut agent = agent(&[0.0; 4]);
        agent.set_action_mask(features(), &[true, false]);
        agent.masks = Some(Box::new(ActionMasks::known(vec![true; 4], 2)));
        agent.set_action_mask(features(), &[true, false]);
    }
}
