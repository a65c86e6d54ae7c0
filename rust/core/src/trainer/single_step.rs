//! Episodes of a single step.

use super::{Budget, EpisodeState, Trainer};
use crate::learners::Learner;
use crate::random::Rng;
use crate::tasks::Task;

impl<T: Task, L: Learner<T::Active>, R: Rng + Clone> Trainer<T, L, R> {
    /// Runs episodes of a task whose episodes are single steps, as the loop over steps would, and subtracts their work.
    ///
    /// The lengths and ends of these episodes are all the same: they are stored at the end, and only the returns in between.
    // In a function of its own the compiler keeps more of the loop in registers.
    #[inline(never)]
    pub(super) fn advance_single_steps(&mut self, rng: &mut R, budget: Budget, work: &mut i64) -> Result<(), T::Error> {
        let mut returns = std::mem::take(&mut self.episodes.returns);
        let before = returns.len();
        // A step takes a work of at least 1. The room is reserved.
        returns.resize(before + (budget.episodes - before).min(*work as usize), 0.0);
        // As in `advance`, local variables need not be loaded and stored.
        let (mut local_rng, mut work_left, mut finished) = (rng.clone(), *work, before);
        let result = 'episodes: {
            for slot in &mut returns[before..] {
                let begun = match self.begin_episode(&mut local_rng) {
                    Ok(begun) => begun,
                    Err(error) => break 'episodes Err(error),
                };
                let EpisodeState { mut state, active, action, mut episode_return, mut length, .. } = begun;
                let transition = match self.task.step(&mut state, action) {
                    Ok(transition) => transition,
                    Err(error) => break 'episodes Err(error),
                };
                episode_return += transition.reward;
                length += 1;
                let action = self.learner.learn(active, action, transition.reward, transition.next, &mut local_rng);
                work_left -= (self.learner.work() + self.task.step_work()).cast_signed();
                if self.learner.is_unfinished() {
                    let unfinished = Some(transition.next);
                    self.episode = Some(EpisodeState { state, active, action, episode_return, length, unfinished });
                    break;
                }
                self.learner.end_episode();
                *slot = episode_return;
                finished += 1;
                if work_left <= 0 || self.learner.diverged() {
                    break;
                }
            }
            Ok(())
        };
        (*rng, *work) = (local_rng, work_left);
        returns.truncate(finished);
        self.episodes.lengths.resize(finished, 1);
        self.episodes.terminated.resize(finished, true);
        self.episodes.returns = returns;
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::StopFlag;
    use crate::learners::{Agent, DynaQ, GradientBandit, Model, QLearning, TdLearner, UpdateRule};
    use crate::policies::{AnyPolicy, TieBreaking};
    use crate::q_table::{QTable, TerminalUpdate};
    use crate::random::{Pcg64, SeedSequence};
    use crate::schedules::{LearningRate, Schedule};
    use crate::tasks::{KArmedBandit, Testbed, VisitCounter};

    const ACTIONS: usize = 4;
    const EPISODES: usize = 300;

    /// Runs with parts of this much work, until nothing happens any more.
    fn train<T, L>(task: T, learner: L, work: u64) -> Trainer<T, L, Pcg64>
    where
        T: Task<Error: std::fmt::Debug>,
        L: Learner<T::Active>,
    {
        let mut trainer = Trainer::new(task, learner, Pcg64::new(&SeedSequence::new(&[4])));
        // A step of a rule that plans is up to three parts of a work of one call.
        for _ in 0..3 * EPISODES {
            trainer.advance(Budget { episodes: EPISODES, work }).expect("a bandit has no bounds to leave");
        }
        trainer
    }

    /// Checks that a bandit gives the same as one within a wrapper, which hides that its episodes are single steps.
    fn check<U: UpdateRule<[u32; 1], Agent> + Clone>(policy: &AnyPolicy, rule: &U, testbed: Testbed) -> usize {
        let agent = Agent {
            table: QTable::new(vec![0.0; ACTIONS], ACTIONS),
            policy: policy.clone(),
            learning_rate: LearningRate::scheduled(Schedule::linear(0.5, 0.1, 200, 0), 1),
            discount: 1.0,
            terminal_update: TerminalUpdate::Target,
            masks: None,
        };
        let learner = TdLearner { agent, rule: rule.clone() };
        let bandit = KArmedBandit::new(testbed, Pcg64::new(&SeedSequence::new(&[5])));
        let hidden = VisitCounter::new(bandit.clone(), 1, ACTIONS, &StopFlag::new()).expect("four counts");
        assert!(bandit.has_single_steps() && !hidden.has_single_steps());
        let expected = train(hidden, learner.clone(), u64::MAX);
        for work in [1, 7, u64::MAX] {
            let trained = train(bandit.clone(), learner.clone(), work);
            assert_eq!(trained.episodes(), expected.episodes());
            assert_eq!(trained.rng, expected.rng);
            let tables = [trained.learner().tables(), expected.learner().tables()];
            let [bits, expected_bits] = tables.map(|tables| tables[0].iter().map(|q| q.to_bits()).collect::<Vec<_>>());
            assert_eq!(bits, expected_bits);
        }
        expected.episodes().returns.len()
    }

    #[test]
    fn single_steps_give_what_the_loop_over_steps_gives() {
        let stop = StopFlag::new();
        let still = Testbed { num_actions: ACTIONS, mean: 0.0, deviation: 1.0, random_walk: 0.0 };
        let walking = Testbed { random_walk: 0.01, ..still };
        let epsilon = Schedule::linear(0.5, 0.1, 250, 20);
        let greedy = AnyPolicy::EpsilonGreedy { epsilon, ties: TieBreaking::Random };
        // Planning that one call of the learner does not finish.
        let dyna = DynaQ::new(Model::new(1, ACTIONS, &stop).expect("a small model"), 10_000);
        let gradient = GradientBandit::new(true, 1, &stop).expect("a state");
        for testbed in [still, walking] {
            assert_eq!(check(&greedy, &QLearning, testbed), EPISODES);
            assert_eq!(check(&AnyPolicy::softmax(1.0, ACTIONS), &gradient, testbed), EPISODES);
        }
        assert_eq!(check(&greedy, &dyna, still), EPISODES);
        // Infinite rewards: the learner diverges, and the run stops after that episode.
        let infinite = Testbed { deviation: f64::MAX, random_walk: f64::MAX, ..still };
        let episodes = check(&AnyPolicy::softmax(1.0, ACTIONS), &gradient, infinite);
        assert!((1..EPISODES).contains(&episodes), "{episodes} episodes");
    }
}
