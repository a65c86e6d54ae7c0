//! Built runs that are saved and loaded, and checkpoints of other runs, which are refused by name.

use crate::LoadError;
use crate::checkpoint::{CheckpointError, EpisodeProgress};
use crate::envs::toy_text::FrozenLake;
use crate::features::{Identity, OutOfBounds};
use crate::learners::{Agent, AnyAlgorithm, QLearning, Sarsa, TdLearner, UpdateRule};
use crate::policies::{AnyPolicy, TieBreaking};
use crate::random::{AgentRng, Pcg64, SeedSequence};
use crate::schedules::{LearningRate, Schedule};
use crate::settings::ScheduleSpec;
use crate::tasks::{BoxedTask, NativeTask, Task, TimeAware, VisitCounter};
use crate::{Budget, QTable, StopFlag, Trainer, TrainerBuilder};

const EPISODES: usize = 50;

fn lake() -> TrainerBuilder<FrozenLake, Identity> {
    let epsilon = ScheduleSpec::linear(1.0, 0.1);
    Trainer::builder(FrozenLake::default(), Identity(16))
        .max_episode_steps(100)
        .episodes(EPISODES as u64)
        .epsilon(epsilon)
}

/// A run that was stopped in the middle of an episode, and its bytes.
fn saved(builder: TrainerBuilder<FrozenLake, Identity>) -> Vec<u8> {
    let mut run = builder.build().expect("valid settings");
    while run.episodes().len() < 5 || run.unfinished_episode().is_none() {
        run.advance(Budget::episodes(EPISODES).with_work(9)).expect("every state has a row");
    }
    run.save().expect("memory suffices")
}

/// The part in which a checkpoint differs from a run.
fn refused(bytes: &[u8], builder: TrainerBuilder<FrozenLake, Identity>) -> String {
    match builder.build().expect("valid settings").load(bytes) {
        Err(LoadError::OtherRun { part, .. }) => part,
        other => format!("{other:?}"),
    }
}

#[test]
fn a_loaded_run_continues_as_if_it_had_never_stopped() {
    for algorithm in [AnyAlgorithm::QLearning, AnyAlgorithm::DoubleQLearning, AnyAlgorithm::NStepSarsa { n_steps: 4 }] {
        let new_run = || lake().algorithm(algorithm).build().expect("valid settings");
        let (mut whole, mut loaded) = (new_run(), new_run());
        let bytes = saved(lake().algorithm(algorithm));
        assert_eq!(loaded.load(&bytes), Ok(EpisodeProgress::Within));
        assert_eq!(loaded.save().as_deref(), Ok(&bytes[..]));
        let rest = EPISODES - loaded.episodes().len();
        whole.train(EPISODES).expect("every state has a row");
        loaded.train(rest).expect("every state has a row");
        assert_eq!((loaded.episodes(), loaded.tables()), (whole.episodes(), whole.tables()));
        assert_eq!(loaded.save(), whole.save());
    }
}

#[test]
fn a_checkpoint_of_other_settings_is_refused_by_name() {
    let bytes = saved(lake());
    assert_eq!(refused(&bytes, lake().algorithm(AnyAlgorithm::Sarsa)), "algorithm");
    assert_eq!(refused(&bytes, lake().seed(1)), "seed");
    assert_eq!(refused(&bytes, lake().discount(0.9)), "discount");
    assert_eq!(refused(&bytes, lake().max_episode_steps(99)), "max_episode_steps");
    let error = lake().seed(1).build().expect("valid settings").load(&bytes).expect_err("another seed");
    assert_eq!(error.to_string(), "the checkpoint is of another run: its seed is 0, but this run's is 1");
}

#[test]
fn what_a_user_adds_to_the_identity_is_compared() {
    let bytes = saved(lake());
    let mut run = lake().build().expect("valid settings");
    run.identify("wind", 0.5);
    let (part, saved, expected) = ("wind".to_owned(), "none".to_owned(), "0.5".to_owned());
    assert_eq!(run.load(&bytes), Err(LoadError::OtherRun { part, saved, expected }));
}

/// A run put together by hand, whose settings nobody wrote down.
fn by_hand<U: UpdateRule<[u32; 1], Agent>>(
    rule: U,
    seed: u64,
) -> Trainer<NativeTask<FrozenLake, Identity>, TdLearner<U>, AgentRng> {
    let seed = SeedSequence::from(seed);
    let task = NativeTask::new(FrozenLake::default(), Identity(16), Some(100), Pcg64::new(&seed));
    let policy = AnyPolicy::EpsilonGreedy { epsilon: Schedule::constant(0.3), ties: TieBreaking::First };
    let agent = Agent::new(QTable::zeros(16, 4), policy, LearningRate::scheduled(Schedule::constant(0.2), 1), 0.9);
    Trainer::new(task, TdLearner { agent, rule }, AgentRng::pcg64(&seed))
}

#[test]
fn a_run_made_by_hand_knows_its_learner_and_its_seeds() {
    let mut run = by_hand(QLearning, 0);
    run.train(20).expect("every state has a row");
    let bytes = run.save().expect("memory suffices");
    assert_eq!(by_hand(QLearning, 0).load(&bytes), Ok(EpisodeProgress::Between));
    let rule = by_hand(Sarsa, 0).load(&bytes).expect_err("another rule").to_string();
    assert!(rule.contains("learner is TdLearner<QLearning>, but this run's is TdLearner<Sarsa>"), "{rule}");
    let seed = by_hand(QLearning, 1).load(&bytes).expect_err("another seed").to_string();
    assert!(seed.contains("seed of the environment's generator"), "{seed}");
}

#[test]
fn a_wrapped_task_is_identified_by_what_it_wraps() {
    let run = |seed: u64| {
        let Trainer { task, learner, rng, .. } = by_hand(QLearning, seed);
        let task = BoxedTask::<_, OutOfBounds>::new(TimeAware::new(task, 16, 5).expect("a small table"));
        assert_eq!(task.shape(), Some((80, 4)));
        assert!(Trainer::try_new(task, learner.clone(), rng.clone()).is_err());
        let task = VisitCounter::new(by_hand(QLearning, seed).task, 16, 4, &StopFlag::new()).expect("a few counts");
        Trainer::try_new(BoxedTask::<_, OutOfBounds>::new(task), learner, rng).expect("the table fits the task")
    };
    let mut saved = run(3);
    saved.train(10).expect("every state has a row");
    let bytes = saved.save().expect("memory suffices");
    assert_eq!(run(3).load(&bytes), Ok(EpisodeProgress::Between));
    let error = run(4).load(&bytes).expect_err("another seed").to_string();
    assert!(error.contains("seed of the environment's generator"), "{error}");
}

#[test]
fn damaged_bytes_are_refused_before_the_run_changes() {
    let bytes = saved(lake());
    let mut run = lake().build().expect("valid settings");
    let damaged = |error| Err(LoadError::Damaged(error));
    for index in [30, bytes.len() / 2, bytes.len() - 1] {
        let mut bytes = bytes.clone();
        bytes[index] ^= 1;
        assert_eq!(run.load(&bytes), damaged(CheckpointError::Invalid("checksum")));
    }
    assert_eq!(run.load(&bytes[..bytes.len() - 9]), damaged(CheckpointError::Invalid("checksum")));
    for other in [&b""[..], b"PK\x03\x04 a file of another kind"] {
        assert_eq!(run.load(other), Err(LoadError::NotACheckpoint));
    }
    let mut later = bytes.clone();
    later[8] = 2;
    assert!(
        matches!(run.load(&later), Err(LoadError::LaterVersion { version }) if version == env!("CARGO_PKG_VERSION"))
    );
    run.load(&bytes).expect("the run is still new");
    assert_eq!(run.load(&bytes), Err(LoadError::AlreadyStarted));
}
