//! Built runs with weighted features.

use crate::checkpoint::EpisodeProgress;
use crate::envs::classic_control::MountainCar;
use crate::features::{ActiveFeatures, Features, FourierBasis};
use crate::learners::{AnyAlgorithm, FeatureKinds, Learner, TargetPolicy, TraceKind, TraceOptions};
use crate::numeric::argmax;
use crate::policies::TieBreaking;
use crate::settings::{LearningRateSpec, PolicySpec};
use crate::{Budget, Trainer, TrainerBuilder};

type Basis = FourierBasis<f32, 64>;

fn car() -> TrainerBuilder<MountainCar, Basis> {
    let basis = Basis::try_new(&[-1.2, -0.07], &[0.6, 0.07], 3, true, true).expect("16 features");
    Trainer::builder(MountainCar::default(), basis).max_episode_steps(200).episodes(10).learning_rate(0.01)
}

fn algorithms() -> [AnyAlgorithm; 16] {
    let traces = TraceOptions { kind: TraceKind::Accumulating, decay: 0.8, cutoff: 0.0 };
    let value_learning_rate = 0.02;
    [
        AnyAlgorithm::QLearning,
        AnyAlgorithm::Sarsa,
        AnyAlgorithm::ExpectedSarsa,
        AnyAlgorithm::DoubleQLearning,
        AnyAlgorithm::NStepSarsa { n_steps: 4 },
        AnyAlgorithm::NStepTreeBackup { n_steps: 4, target_policy: TargetPolicy::Behavior },
        AnyAlgorithm::NStepQSigma { n_steps: 3, sigma: 0.5, target_policy: TargetPolicy::Greedy },
        AnyAlgorithm::DifferentialSarsa { reward_learning_rate: 0.01 },
        AnyAlgorithm::DifferentialQLearning { reward_learning_rate: 0.01 },
        AnyAlgorithm::SarsaLambda(traces),
        AnyAlgorithm::TrueOnlineSarsaLambda { trace_decay: 0.8, trace_cutoff: 1e-3 },
        AnyAlgorithm::WatkinsQLambda(traces),
        AnyAlgorithm::Reinforce,
        AnyAlgorithm::ReinforceWithBaseline { value_learning_rate },
        AnyAlgorithm::ActorCritic { value_learning_rate },
        AnyAlgorithm::ActorCriticLambda { value_learning_rate, trace_decay: 0.8 },
    ]
}

/// A run of an algorithm, with its policy.
fn run_of(algorithm: AnyAlgorithm) -> TrainerBuilder<MountainCar, Basis> {
    let run = car().algorithm(algorithm);
    if algorithm.learns_preferences() { run.policy(PolicySpec::Softmax { temperature: 1.0 }) } else { run }
}

#[test]
fn a_saved_run_continues_within_an_episode_as_if_it_had_never_stopped() {
    for algorithm in algorithms() {
        let new_run = || run_of(algorithm).build().expect("valid settings");
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
fn every_instruction_set_learns_the_same_weights() {
    let bits = |tables: Vec<&[f64]>| -> Vec<u64> { tables.concat().iter().map(|weight| weight.to_bits()).collect() };
    for algorithm in algorithms() {
        let (mut wide, mut narrow) =
            (run_of(algorithm).build().expect("valid"), run_of(algorithm).build().expect("valid"));
        let budget = Budget::episodes(3).with_work(10_000);
        wide.advance(budget).expect("finite observations");
        narrow.reserve(budget).expect("memory suffices");
        let mut rng = narrow.rng.clone();
        narrow.advance_with(&mut rng, budget).expect("finite observations");
        narrow.learner.complete_tables();
        assert_eq!(wide.episodes(), narrow.episodes(), "{algorithm:?}");
        assert_eq!(bits(wide.tables()), bits(narrow.tables()), "{algorithm:?}");
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
    let binary = AnyAlgorithm::SarsaLambda(TraceOptions { kind: TraceKind::Replacing, ..TraceOptions::default() });
    assert_eq!(binary.feature_kinds(), FeatureKinds::Binary);
    for algorithm in
        [binary, AnyAlgorithm::DynaQ { planning_steps: 5 }, AnyAlgorithm::MonteCarlo { max_episode_steps: 9 }]
    {
        let refused = message(car().algorithm(algorithm));
        let expected = "algorithm must be one that learns with weighted features, without replacing traces, got ";
        assert!(refused.starts_with(expected), "{refused}");
    }
    let by_visit_count = message(car().learning_rate(LearningRateSpec::by_visit_count(1.0, 0.0)));
    assert_eq!(by_visit_count, "learning_rate must be a schedule with weighted features, got one by visits");
    let ucb = PolicySpec::Ucb { confidence: 2.0, ties: TieBreaking::First };
    assert!(message(car().policy(ucb)).starts_with("policy must be one without counts"));
}
