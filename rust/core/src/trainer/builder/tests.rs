//! Runs that are built equal runs that are put together by hand, and settings that do not fit are refused by name.

use super::*;
use crate::envs::classic_control::MountainCar;
use crate::envs::toy_text::FrozenLake;
use crate::features::{Identity, TileCoding};
use crate::learners::{Agent, Learner, Sarsa, TargetPolicy, TdLearner, TraceKind, TraceOptions};
use crate::policies::AnyPolicy;
use crate::random::{Pcg64, SeedSequence};
use crate::schedules::{LearningRate, Schedule};

fn lake() -> TrainerBuilder<FrozenLake, Identity> {
    Trainer::builder(FrozenLake::default(), Identity(16)).max_episode_steps(100)
}

fn car() -> TrainerBuilder<MountainCar, TileCoding<f32>> {
    let tiles = TileCoding::try_new(&[-1.2, -0.07], &[0.6, 0.07], &[8, 8], 8).expect("valid tilings");
    Trainer::builder(MountainCar::default(), tiles).max_episode_steps(200)
}

fn message<E: Env<Action = usize>, F: Features<E::Observation>>(builder: TrainerBuilder<E, F>) -> String {
    builder.build().err().map(|error| error.to_string()).unwrap_or_default()
}

#[test]
fn a_built_run_equals_one_put_together_by_hand() {
    let built = lake().algorithm(AnyAlgorithm::Sarsa).learning_rate(0.2).epsilon(0.3).initial_uniform(0.0, 1.0).seed(5);
    let mut built = built.build().expect("valid settings");
    let seed = SeedSequence::new(&[5]);
    let mut rng = AgentRng::pcg64(&seed);
    let task = NativeTask::new(FrozenLake::default(), Identity(16), Some(100), Pcg64::new(&seed));
    let policy = AnyPolicy::EpsilonGreedy { epsilon: Schedule::constant(0.3), ties: TieBreaking::Random };
    let table = QTable::uniform(16, 4, 0.0, 1.0, &mut rng);
    let agent = Agent::new(table, policy, LearningRate::scheduled(Schedule::constant(0.2), 1), 0.99);
    let mut by_hand = Trainer::new(task, TdLearner { agent, rule: Sarsa }, rng);
    let returns = by_hand.train(200).expect("every state has a row").to_vec();
    assert_eq!(built.train(200), Ok(&returns[..]));
    assert_eq!(built.tables(), by_hand.tables());
}

#[test]
fn every_algorithm_trains() {
    use AnyAlgorithm as A;
    let traces = TraceOptions { kind: TraceKind::Replacing, decay: 0.9, cutoff: 0.0 };
    let (n_steps, sigma, target_policy, planning_steps) = (3, 0.5, TargetPolicy::Greedy, 2);
    let (value_learning_rate, trace_decay, max_episode_steps) = (0.1, 0.8, 0);
    let any_rows = [
        A::QLearning,
        A::Sarsa,
        A::ExpectedSarsa,
        A::DoubleQLearning,
        A::NStepSarsa { n_steps },
        A::NStepTreeBackup { n_steps, target_policy },
        A::NStepQSigma { n_steps, sigma, target_policy },
        A::SarsaLambda(traces),
        A::TrueOnlineSarsaLambda { trace_decay, trace_cutoff: 0.0 },
        A::WatkinsQLambda(traces),
        A::DifferentialSarsa { reward_learning_rate: 0.01 },
        A::DifferentialQLearning { reward_learning_rate: 0.01 },
        A::Reinforce,
        A::ReinforceWithBaseline { value_learning_rate },
        A::ActorCritic { value_learning_rate },
        A::ActorCriticLambda { value_learning_rate, trace_decay },
    ];
    let single_rows = [
        A::DynaQ { planning_steps },
        A::DynaQPlus { planning_steps, time_weight: 1e-3 },
        A::StochasticDynaQ { planning_steps },
        A::PrioritizedSweeping { planning_steps, priority_threshold: 1e-4 },
        A::MonteCarlo { max_episode_steps },
        A::MonteCarloEs { max_episode_steps },
        A::OffPolicyMonteCarlo { max_episode_steps, learning_rate: 1.0, min_learning_rate: 0.0 },
        A::GradientBandit { baseline: true },
    ];
    for algorithm in any_rows {
        let builder = car().algorithm(algorithm);
        let mut run = softmax_for(algorithm, builder).build().expect("valid settings");
        assert_eq!(run.train(2).map(<[f64]>::len), Ok(2), "{algorithm:?}");
    }
    for algorithm in any_rows.into_iter().chain(single_rows) {
        let mut run = softmax_for(algorithm, lake().algorithm(algorithm)).build().expect("valid settings");
        assert_eq!(run.train(20).map(<[f64]>::len), Ok(20), "{algorithm:?}");
        assert_eq!(run.tables().len(), algorithm.n_tables());
    }
    for algorithm in single_rows {
        let refused = message(softmax_for(algorithm, car().algorithm(algorithm)));
        assert!(refused.starts_with("the number of active rows must be 1"), "{refused}");
    }
}

fn softmax_for<E, F>(algorithm: AnyAlgorithm, builder: TrainerBuilder<E, F>) -> TrainerBuilder<E, F> {
    if algorithm.learns_preferences() { builder.policy(PolicySpec::Softmax { temperature: 1.0 }) } else { builder }
}

#[test]
fn what_does_not_fit_is_refused_by_name() {
    let three = message(lake().initial_table(QTable::zeros(16, 3)));
    let expected = "one of 16 rows and 4 actions, as the features and the environment have";
    assert_eq!(three, format!("initial_table must be {expected}, got 16 rows and 3 actions"));
    let few = message(lake().initial_table(QTable::zeros(15, 4)));
    assert_eq!(few, format!("initial_table must be {expected}, got 15 rows and 4 actions"));
    let backwards = TileCoding::<f32>::new(&[0.6, -0.07], &[-1.2, 0.07], &[8, 8], 8);
    let backwards = message(Trainer::builder(MountainCar::default(), backwards));
    assert!(backwards.starts_with("high must be finite and above low"), "{backwards}");
    let narrow = message(Trainer::builder(FrozenLake::default(), Identity(0)));
    assert_eq!(narrow, "the number of rows of the features must be from 1 to 2**32 - 1, got 0");
    assert_eq!(message(lake().learning_rate(1.5)), "learning_rate must be a number in [0, 1], got 1.5");
    assert_eq!(message(car().learning_rate(1.5)), "");
    assert_eq!(message(lake().discount(f64::NAN)), "discount must be a number in [0, 1], got NaN");
    assert_eq!(message(lake().epsilon(-0.1)), "epsilon must be a number in [0, 1], got -0.1");
    let linear = lake().epsilon(ScheduleSpec::linear(1.0, 0.1));
    assert_eq!(message(linear.clone()), "episodes must be given, because epsilon falls linearly, got none");
    assert_eq!(message(linear.episodes(10)), "");
    let reinforce = message(lake().algorithm(AnyAlgorithm::Reinforce));
    assert_eq!(reinforce, "policy must be Softmax for an algorithm that learns preferences, got EpsilonGreedy");
    let softmax = || lake().policy(PolicySpec::Softmax { temperature: 1.0 });
    let true_online = AnyAlgorithm::TrueOnlineSarsaLambda { trace_decay: 0.9, trace_cutoff: 0.0 };
    for run in [lake().algorithm(true_online), softmax().algorithm(AnyAlgorithm::Reinforce)] {
        let by_visit_count = message(run.learning_rate(LearningRateSpec::by_visit_count(1.0, 0.0)));
        assert_eq!(by_visit_count, "learning_rate must be a schedule for this algorithm, got one by visits");
    }
    let ucb = PolicySpec::Ucb { confidence: 2.0, ties: TieBreaking::First };
    assert!(message(car().policy(ucb)).starts_with("policy must be one without counts"));
    assert_eq!(message(lake().algorithm(AnyAlgorithm::NStepSarsa { n_steps: 0 })), "n_steps must be at least 1, got 0");
    let unlimited = Trainer::builder(FrozenLake::default(), Identity(16));
    let monte_carlo = message(unlimited.algorithm(AnyAlgorithm::MonteCarlo { max_episode_steps: 100 }));
    assert_eq!(monte_carlo, "max_episode_steps must be given for a Monte Carlo method, got none");
    assert!(message(lake().initial_value(f64::INFINITY)).starts_with("initial_value must be a finite number"));
    assert!(message(car().terminal_update(TerminalUpdate::Assign)).starts_with("terminal_update must"));
}

#[test]
fn a_built_learner_shows_its_agent() {
    let run = car().learning_rate(0.5).build().expect("valid settings");
    let agent = run.learner().agent();
    assert_eq!((agent.learning_rate.n_active(), agent.discount), (8.0, 0.99));
    assert_eq!(Learner::<<TileCoding<f32> as Features<[f32; 2]>>::Active>::shape(run.learner()), run.shape());
}
