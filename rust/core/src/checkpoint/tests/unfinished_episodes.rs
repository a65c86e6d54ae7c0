//! Checkpoints within an episode: at its time limit, and in tasks that cannot resume it.

use super::{ACTIONS, LIMIT, Setup};
use crate::checkpoint::{Checkpoint, CheckpointError, EpisodeProgress, Persist};
use crate::envs::classic_control::MountainCar;
use crate::features::{Axis, Features, Rounding};
use crate::learners::{Agent, MonteCarloControl, NStepSarsa, QLearning, Reinforce, TdLearner, TransformedSteps};
use crate::policies::AnyPolicy;
use crate::random::{AgentRng, Pcg64, SeedSequence};
use crate::tasks::{NativeTask, Next, Task, TimeAware, Transition};
use crate::{Budget, Learner, StopFlag, Trainer};

const SETUP: Setup = Setup { steps: 0, limit: LIMIT, seed: 7, mt19937: false, visits: false, damage: Vec::new() };

/// A time limit so long that learning from an episode takes several calls.
const LONG: u64 = 9000;

/// Saves a run at its time limit, while the learner is still learning from the episode. Each step has separate rows,
/// and the environment never ends an episode.
fn check_at_the_limit<L: Learner<[u32; 1]>>(learner: impl Fn(usize) -> L) {
    let grid = Rounding::new([Axis::new(-1.2_f32, 0.6, 1.0), Axis::new(-0.07_f32, 0.07, 10.0)]);
    let (rows, seed) = (Features::<[f32; 2]>::len(&grid), SeedSequence::new(&[7]));
    let new_run = || {
        let car = MountainCar { goal_velocity: 1.0, ..MountainCar::default() };
        let task = NativeTask::new(car, grid.clone(), Some(LONG), Pcg64::new(&seed));
        let task = TimeAware::new(task, rows, LONG).expect("a small table");
        let learner = learner(task.n_rows());
        Trainer::new(task, TransformedSteps { learner, terminate: true, bonus: None }, AgentRng::pcg64(&seed))
    };
    let (mut whole, mut stopped) = (new_run(), new_run());
    let finish = |run: &mut Trainer<_, _, AgentRng>| {
        while run.episodes().returns.is_empty() {
            run.advance(Budget { episodes: 1, work: 1 << 16 }).expect("all observations have rows");
        }
    };
    finish(&mut whole);
    let mut at_the_limit = 0;
    while stopped.episodes().returns.is_empty() {
        stopped.advance(Budget { episodes: 1, work: 1000 }).expect("all observations have rows");
        if !stopped.learner().is_unfinished() {
            continue;
        }
        at_the_limit += 1;
        let mut bytes = Vec::new();
        stopped.persist(&mut Checkpoint::save(&mut bytes)).expect("memory suffices");
        let mut resumed = new_run();
        resumed
            .restore(stopped.episodes().clone(), &stopped.learner().tables())
            .expect("the tables have the same size");
        let progress = resumed.persist(&mut Checkpoint::restore(&bytes));
        assert_eq!(progress, Ok(EpisodeProgress::Within));
        finish(&mut resumed);
        assert_eq!(resumed.learner().tables(), whole.learner().tables());
    }
    assert!(at_the_limit > 0, "all was learned in one call");
}

#[test]
fn a_run_resumes_while_the_last_step_before_the_limit_is_learned_from() {
    let stop = StopFlag::new();
    check_at_the_limit(|rows| TdLearner { agent: SETUP.agent(rows, 1), rule: NStepSarsa::new(8000) });
    check_at_the_limit(|rows| {
        let rule = MonteCarloControl::new(rows * ACTIONS, LONG, false, &stop).expect("a few pairs");
        TdLearner { agent: SETUP.agent(rows, 1), rule }
    });
    check_at_the_limit(|rows| {
        let agent = Agent { policy: AnyPolicy::softmax(1.0, ACTIONS), ..SETUP.agent(rows, 1) };
        TdLearner { agent, rule: Reinforce::new(None) }
    });
}

/// A task with two states and one action, which fails at the given step.
#[derive(Clone)]
struct Failing {
    steps: u64,
    resumes: bool,
}

impl Task for Failing {
    type State = u64;
    type Active = [u32; 1];
    type Error = ();

    fn reset(&mut self) -> Result<(u64, [u32; 1]), ()> {
        Ok((0, [0]))
    }

    fn step(&mut self, state: &mut u64, _action: usize) -> Result<Transition<[u32; 1]>, ()> {
        self.steps = self.steps.checked_sub(1).ok_or(())?;
        *state += 1;
        let next = if *state == 3 { Next::Terminal } else { Next::NonTerminal([1]) };
        Ok(Transition { reward: 1.0, next })
    }

    fn active_rows(&self, _state: &u64) -> Result<[u32; 1], ()> {
        Ok([1])
    }

    fn resumes_episodes(&self) -> bool {
        self.resumes
    }

    fn persist(&mut self, state: Option<&mut u64>, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        state.map_or(Ok(()), |state| state.persist(checkpoint))
    }
}

fn failing(steps: u64, resumes: bool) -> Trainer<Failing, TdLearner<QLearning>, Pcg64> {
    let agent = SETUP.agent(2, 1);
    Trainer::new(Failing { steps, resumes }, TdLearner { agent, rule: QLearning }, Pcg64::new(&SeedSequence::new(&[1])))
}

#[test]
fn a_checkpoint_reports_whether_an_episode_was_lost() {
    let budget = |work| Budget { episodes: 9, work };
    for (resumes, work, expected) in [
        (true, 4, EpisodeProgress::Within),
        (false, 4, EpisodeProgress::Abandoned),
        (false, 3, EpisodeProgress::Between),
        (true, 100, EpisodeProgress::Abandoned),
        (false, 100, EpisodeProgress::Abandoned),
    ] {
        let (mut run, mut bytes) = (failing(7, resumes), Vec::new());
        assert_eq!(run.advance(budget(work)).is_err(), work == 100);
        assert_eq!(run.persist(&mut Checkpoint::save(&mut bytes)), Ok(expected));
        assert_eq!(failing(9, resumes).persist(&mut Checkpoint::restore(&bytes)), Ok(expected));
    }
}

#[test]
fn an_episode_that_the_task_cannot_resume_is_refused() {
    let (mut run, mut bytes) = (failing(7, true), Vec::new());
    run.advance(Budget { episodes: 9, work: 4 }).expect("seven steps");
    run.persist(&mut Checkpoint::save(&mut bytes)).expect("memory suffices");
    let refused = failing(7, false).persist(&mut Checkpoint::restore(&bytes));
    assert_eq!(refused, Err(CheckpointError::Invalid("progress of an episode")));
}
