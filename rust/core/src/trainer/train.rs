//! Training by numbers of episodes, and what was learned.

use super::{Budget, Trainer};
use crate::errors::{BuildError, TrainingError};
use crate::learners::Learner;
use crate::policies::GreedyPolicy;
use crate::random::Rng;
use crate::tasks::Task;

/// The work of a part of training: learners that store every step reserve memory for as many.
const WORK_OF_A_PART: u64 = 1 << 16;

impl<T: Task, L: Learner<T::Active>, R: Rng + Clone> Trainer<T, L, R> {
    /// A run that has not taken a step yet, whose learner fits the task.
    ///
    /// # Errors
    /// `Invalid` if the tables have other numbers of rows or actions than the task, as far as
    /// [the task knows them](Task::shape).
    pub fn try_new(task: T, learner: L, rng: R) -> Result<Self, BuildError> {
        let (rows, actions) = learner.shape();
        let shape = task.shape().unwrap_or((rows, actions));
        let expected = format_args!("one of {} rows and {} actions, as the task has", shape.0, shape.1);
        let got = format_args!("{rows} rows and {actions} actions");
        BuildError::check(shape == (rows, actions), "table", expected, got)?;
        Ok(Self::new(task, learner, rng))
    }

    /// Trains for this many more episodes and returns their returns. [`advance`](Self::advance) trains in smaller parts.
    ///
    /// # Errors
    /// As for `advance`; and `Diverged` if any value of the tables is infinite or NaN afterwards. An unavailable action
    /// may have the value -∞.
    pub fn train(&mut self, episodes: usize) -> Result<&[f64], TrainingError<T::Error>> {
        let finished = self.episodes.returns.len();
        let budget = Budget::episodes(finished.saturating_add(episodes)).with_work(WORK_OF_A_PART);
        // Each call takes a step, or returns an error.
        while self.episodes.returns.len() < budget.episodes {
            self.advance(budget)?;
        }
        self.check_divergence()?;
        let has_overflowed = |value: &f64| value.is_nan() || *value == f64::INFINITY;
        if self.learner.tables().into_iter().flatten().any(has_overflowed) {
            return Err(TrainingError::Diverged { episode: self.last_episode() });
        }
        Ok(&self.episodes.returns[finished..])
    }

    /// The values of the learner's tables, row by row.
    pub fn tables(&self) -> Vec<&[f64]> {
        self.learner.tables()
    }

    /// The number of rows and of actions of each table.
    pub fn shape(&self) -> (usize, usize) {
        self.learner.shape()
    }

    /// Whether an action value has overflowed, so that further training is meaningless.
    pub fn diverged(&self) -> bool {
        self.learner.diverged()
    }

    /// The greedy policy of what was learned so far.
    pub fn greedy_policy(&self) -> GreedyPolicy {
        GreedyPolicy::new(&self.learner.policy_tables(), self.learner.shape().1, self.learner.action_masks())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envs::classic_control::MountainCar;
    use crate::features::TileCoding;
    use crate::learners::{Agent, QLearning, TdLearner};
    use crate::policies::EpsilonGreedy;
    use crate::q_table::{QTable, TerminalUpdate};
    use crate::random::{Pcg64, SeedSequence};
    use crate::tasks::NativeTask;

    const TILINGS: usize = 8;

    type Run<const N: usize> =
        Trainer<NativeTask<MountainCar, TileCoding<f32>>, TdLearner<QLearning, Agent<N, EpsilonGreedy, f64>>, Pcg64>;

    /// Q-learning on tiles, with the same step size for each of them.
    fn run<const N: usize>(step_size: f64) -> Run<N> {
        let seed = SeedSequence::from(0);
        let tiles = TileCoding::new(&[-1.2, -0.07], &[0.6, 0.07], &[8, 8], TILINGS as u32);
        let agent = Agent {
            table: QTable::new(vec![0.0; TILINGS * 9 * 9 * 3], 3),
            policy: EpsilonGreedy::linear(0.1, 0.1, 1),
            learning_rate: step_size,
            discount: 1.0,
            terminal_update: TerminalUpdate::Target,
            masks: None,
        };
        let task = NativeTask::new(MountainCar::default(), tiles, Some(200), Pcg64::new(&seed));
        Trainer::new(task, TdLearner { agent, rule: QLearning }, Pcg64::new(&seed))
    }

    #[test]
    fn training_counts_further_episodes() {
        let mut run = run::<0>(0.5 / TILINGS as f64);
        assert_eq!(run.train(3).map(<[f64]>::len), Ok(3));
        assert_eq!(run.train(2).map(<[f64]>::len), Ok(2));
        assert_eq!((run.episodes().returns.len(), run.diverged()), (5, false));
        assert_eq!(run.greedy_policy().shape(), run.shape());
    }

    #[test]
    fn divergence_ends_every_loop() {
        // A step size that was not divided by the number of tilings.
        let mut run = run::<0>(1.0);
        let mut calls = 0;
        let error = loop {
            calls += 1;
            if let Err(error) = run.advance(Budget::episodes(200).with_work(1000)) {
                break error;
            }
            assert!(calls < 200, "the run neither ends nor diverges");
        };
        let TrainingError::Diverged { episode } = error else { unreachable!("the values overflow, got {error}") };
        assert!(episode < 200 && run.diverged());
        assert_eq!(run.advance(Budget::episodes(200)), Err(error));
        assert_eq!(run.train(1), Err(error));
        assert!(error.to_string().contains("smaller learning rate"), "{error}");
    }

    #[test]
    fn a_table_of_another_task_is_refused() {
        let run = run::<0>(0.1);
        let (task, mut learner, rng) = (run.task, run.learner, run.rng);
        assert!(Trainer::try_new(task.clone(), learner.clone(), rng.clone()).is_ok());
        learner.agent.table = QTable::new(vec![0.0; TILINGS * 9 * 9 * 2], 2);
        let error = Trainer::try_new(task, learner, rng).expect_err("a table for two actions").to_string();
        assert_eq!(error, "table must be one of 648 rows and 3 actions, as the task has, got 648 rows and 2 actions");
    }

    #[test]
    fn an_overflow_that_no_learner_reads_is_found() {
        let mut run = run::<0>(0.1);
        *run.learner.agent.table.value_mut(0, 2) = f64::NAN;
        assert_eq!(run.train(0), Err(TrainingError::Diverged { episode: 0 }));
    }
}
