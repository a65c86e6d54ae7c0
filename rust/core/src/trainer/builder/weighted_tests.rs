//! Built runs with weighted features.

use crate::checkpoint::EpisodeProgress;
use crate::envs::classic_control::MountainCar;
use crate::features::{ActiveFeatures, Features, FourierBasis};
use crate::learners::{
    Agent, AnyAlgorithm, FeatureKinds, Learner, TargetPolicy, TdLearner, TraceOptions, Traces, TrueOnlineSarsaLambda,
};
use crate::numeric::argmax;
use crate::policies::{AnyPolicy, TieBreaking};
use crate::random::{Pcg64, SeedSequence};
use crate::schedules::{LearningRate, Schedule};
use crate::settings::{LearningRateSpec, PolicySpec};
use crate::tasks::Next;
use crate::{Budget, QTable, StopFlag, Trainer, TrainerBuilder};

type Basis = FourierBasis<f32, 64>;

fn car() -> TrainerBuilder<MountainCar, Basis> {
    let basis = Basis::try_new(&[-1.2, -0.07], &[0.6, 0.07], 3, true, true).expect("16 features");
    Trainer::builder(MountainCar::default(), basis).max_episode_steps(200).episodes(10).learning_rate(0.01)
}

fn algorithms() -> [AnyAlgorithm; 7] {
    [
        AnyAlgorithm::QLearning,
        AnyAlgorithm::Sarsa,
        AnyAlgorithm::ExpectedSarsa,
        AnyAlgorithm::DoubleQLearning,
        AnyAlgorithm::NStepSarsa { n_steps: 4 },
        AnyAlgorithm::NStepQSigma { n_steps: 3, sigma: 0.5, target_policy: TargetPolicy::Greedy },
        AnyAlgorithm::DifferentialSarsa { reward_learning_rate: 0.01 },
    ]
}

#[test]
fn a_saved_run_continues_within_an_episode_as_if_it_had_never_stopped() {
    for algorithm in algorithms() {
        let new_run = || car().algorithm(algorithm).build().expect("valid settings");
        let (mut whole, mut saved, mut loaded) = (new_run(), new_run(), new_run());
        while saved.episodes().len() < 3 || saved.unfinished_episode().is_none() {
            saved.advance(Budget::episodes(10).with_work(97)).expect("finite observations");
        }
        let bytes = saved.save().expect("memory suffices");
        assert_eq!(loaded.load(&bytes), Ok(EpisodeProgress::Within));
        let rest = 10 - loaded.episodes().len();
        loaded.train(rest).expect("finite observations");
        whole.train(10).expect("finite observations");
        assert_eq!(loaded.episodes(), whole.episodes(), "{algorithm:?}");
        assert_eq!(loaded.save(), whole.save(), "{algorithm:?}");
        assert!(whole.tables()[0].iter().all(|&weight| weight != 0.0));
    }
}

#[test]
fn the_greedy_policy_multiplies_by_the_features() {
    let mut run = car().algorithm(AnyAlgorithm::Sarsa).build().expect("valid settings");
    run.train(3).expect("finite observations");
    let basis = Basis::try_new(&[-1.2, -0.07], &[0.6, 0.07], 3, true, true).expect("16 features");
    let features = basis.active_rows(&[-0.5, 0.01]).expect("a finite observation");
    let weights = run.tables()[0];
    let values: Vec<f64> = (0..3)
        .map(|action| {
            let mut parts = [0.0; 4];
            for (row, x) in features.values().iter().enumerate() {
                parts[row % 4] += weights[3 * row + action] * x;
            }
            (parts[0] + parts[1]) + (parts[2] + parts[3])
        })
        .collect();
    assert_eq!(run.greedy_policy().action_values(features), values);
    assert_eq!(run.greedy_policy().action(features), argmax(&values));
}

#[test]
fn what_has_no_meaning_with_weighted_features_is_refused_by_name() {
    let message = |builder: TrainerBuilder<MountainCar, Basis>| {
        builder.build().err().map(|error| error.to_string()).unwrap_or_default()
    };
    let binary = AnyAlgorithm::SarsaLambda(TraceOptions::default());
    assert_eq!(binary.feature_kinds(), FeatureKinds::Binary);
    for algorithm in
        [binary, AnyAlgorithm::DynaQ { planning_steps: 5 }, AnyAlgorithm::MonteCarlo { max_episode_steps: 9 }]
    {
        let refused = message(car().algorithm(algorithm));
        assert!(refused.starts_with("algorithm must be one that learns with weighted features"), "{refused}");
    }
    let by_visit_count = message(car().learning_rate(LearningRateSpec::by_visit_count(1.0, 0.0)));
    assert_eq!(by_visit_count, "learning_rate must be a schedule with weighted features, got one by visits");
    let ucb = PolicySpec::Ucb { confidence: 2.0, ties: TieBreaking::First };
    assert!(message(car().policy(ucb)).starts_with("policy must be one without counts"));
}

#[test]
#[should_panic(expected = "needs binary features")]
fn a_rule_that_does_not_multiply_by_the_features_is_not_run_on_them() {
    let basis = Basis::try_new(&[-1.2, -0.07], &[0.6, 0.07], 3, true, true).expect("16 features");
    let features = basis.active_rows(&[-0.5, 0.01]).expect("a finite observation");
    let stop = StopFlag::new();
    let rate = LearningRate::scheduled(Schedule::constant(0.1), 1);
    let policy = AnyPolicy::EpsilonGreedy { epsilon: Schedule::constant(0.1), ties: TieBreaking::First };
    let rule = TrueOnlineSarsaLambda::new(Traces::new(48, 0.0, &stop).expect("a few weights"), 0.9);
    let mut learner = TdLearner { agent: Agent::new(QTable::zeros(16, 3), policy, rate, 1.0), rule };
    learner.learn(features, 0, -1.0, Next::Terminal, &mut Pcg64::new(&SeedSequence::from(0)));
}
