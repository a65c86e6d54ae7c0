//! A run that is saved and restored at any step continues as if nothing had happened, for every learner.

mod unfinished_episodes;

use proptest::prelude::*;

use super::Checkpoint;
use crate::envs::classic_control::MountainCar;
use crate::features::{Axis, Features, Rounding, TileCoding};
use crate::learners::{
    ActorCritic, ActorCriticLambda, Agent, Critic, DifferentialQLearning, DifferentialSarsa, DoubleQLearning, DynaQ,
    DynaQPlus, ExpectedSarsa, Model, MonteCarloControl, NStepQSigma, NStepSarsa, NStepTreeBackup, OffPolicyMonteCarlo,
    PrioritizedSweeping, QLearning, Reinforce, Sarsa, SarsaLambda, StochasticModel, TargetPolicy, TdLearner, TraceKind,
    Traces, TrueOnlineSarsaLambda, WatkinsQLambda,
};
use crate::policies::{AnyPolicy, TieBreaking};
use crate::q_table::TerminalUpdate;
use crate::random::{AgentRng, Pcg64, SeedSequence};
use crate::schedules::{LearningRate, Schedule};
use crate::tasks::NativeTask;
use crate::{Budget, Learner, QTable, StopFlag, Trainer};

const ACTIONS: usize = 3;
const EPISODES: usize = 6;
const LIMIT: u64 = 40;

type Run<F, L> = Trainer<NativeTask<MountainCar, F>, L, AgentRng>;

/// The construction of a run, and the step at which it is saved.
#[derive(Clone, Debug)]
struct Setup {
    steps: u64,
    /// The time limit of the episodes.
    limit: u64,
    seed: u32,
    mt19937: bool,
    visits: bool,
    /// The bytes of the checkpoint to damage, with their new values. The run then need not be restored.
    damage: Vec<(prop::sample::Index, u8)>,
}

impl Setup {
    fn agent(&self, rows: usize, n_active: usize) -> Agent {
        let schedule = Schedule::linear(0.5, 0.1, EPISODES as u64, 0);
        Agent {
            table: QTable::new(vec![0.0; rows * ACTIONS], ACTIONS),
            policy: AnyPolicy::EpsilonGreedy { epsilon: schedule, ties: TieBreaking::Random },
            learning_rate: if self.visits {
                LearningRate::by_visit_count(1.0, 0.1, rows * ACTIONS, n_active, &StopFlag::new())
                    .expect("a few counts")
            } else {
                LearningRate::scheduled(schedule, n_active)
            },
            discount: 0.9,
            terminal_update: TerminalUpdate::Target,
            masks: None,
        }
    }

    fn run<F, L>(&self, features: F, learner: L) -> Run<F, L>
    where
        F: Features<[f32; 2]>,
        L: Learner<F::Active>,
    {
        let seed = SeedSequence::new(&[self.seed]);
        let task = NativeTask::new(MountainCar::default(), features, Some(self.limit), Pcg64::new(&seed));
        let rng = if self.mt19937 { AgentRng::mt19937(self.seed) } else { AgentRng::pcg64(&seed) };
        Trainer::new(task, learner, rng)
    }

    /// Compares an uninterrupted run with one that is saved after some steps and restored into a new run.
    fn check<F, L>(&self, features: &F, learner: impl Fn() -> L)
    where
        F: Features<[f32; 2]> + Clone,
        L: Learner<F::Active>,
    {
        let new_run = || self.run(features.clone(), learner());
        if !self.damage.is_empty() {
            return self.check_damaged(new_run);
        }
        let (mut whole, mut stopped, mut resumed) = (new_run(), new_run(), new_run());
        let advance = |run: &mut Run<F, L>, steps| {
            run.advance(Budget { episodes: EPISODES, work: steps }).expect("all observations have rows");
        };
        // In parts, for which some learners allocate memory.
        let finish = |run: &mut Run<F, L>| {
            while run.episodes().returns.len() < EPISODES {
                advance(run, 1 << 16);
            }
        };
        finish(&mut whole);
        advance(&mut stopped, self.steps);
        let tables = stopped.learner().tables().into_iter().map(<[f64]>::to_vec).collect::<Vec<_>>();
        let mut bytes = Vec::new();
        stopped.persist(&mut Checkpoint::save(&mut bytes)).expect("memory suffices");
        let tables = tables.iter().map(Vec::as_slice).collect::<Vec<_>>();
        resumed.restore(stopped.episodes().clone(), &tables).expect("the tables have the same size");
        let mut checkpoint = Checkpoint::restore(&bytes);
        resumed.persist(&mut checkpoint).expect("the bytes are those of this run");
        checkpoint.finish().expect("all bytes are read");
        finish(&mut resumed);
        assert_eq!(resumed.episodes(), whole.episodes());
        assert_eq!(resumed.learner().tables(), whole.learner().tables());
        let mut states = [Vec::new(), Vec::new()];
        for (run, state) in [&mut whole, &mut resumed].into_iter().zip(&mut states) {
            run.persist(&mut Checkpoint::save(state)).expect("memory suffices");
        }
        assert_eq!(states[0], states[1]);
    }

    /// Restores a run from damaged bytes, or detects the damage. Neither panics, and the run can still be advanced.
    fn check_damaged<F, L>(&self, new_run: impl Fn() -> Run<F, L>)
    where
        F: Features<[f32; 2]>,
        L: Learner<F::Active>,
    {
        let (mut run, mut restored, mut bytes) = (new_run(), new_run(), Vec::new());
        run.advance(Budget { episodes: EPISODES, work: self.steps }).expect("all observations have rows");
        run.persist(&mut Checkpoint::save(&mut bytes)).expect("memory suffices");
        for (index, value) in &self.damage {
            let index = index.index(bytes.len());
            bytes[index] = *value;
        }
        if restored.persist(&mut Checkpoint::restore(&bytes)).is_ok() {
            let _ = restored.advance(Budget { episodes: 2, work: 1000 });
        }
    }

    /// The learners that work with any features.
    fn check_all<F: Features<[f32; 2]> + Clone>(&self, features: &F, n_active: usize) {
        let rows = features.len();
        let agent = || self.agent(rows, n_active);
        let traces = || Traces::new(rows * ACTIONS, 1e-3, &StopFlag::new()).expect("a few traces");
        let kind = TraceKind::Replacing;
        self.check(features, || TdLearner { agent: agent(), rule: QLearning });
        self.check(features, || TdLearner { agent: agent(), rule: Sarsa });
        self.check(features, || TdLearner { agent: agent(), rule: ExpectedSarsa });
        let zeros = || QTable::new(vec![0.0; rows * ACTIONS], ACTIONS);
        self.check(features, || {
            let agent = agent();
            let rule = DoubleQLearning::new(agent.learning_rate.clone(), zeros());
            TdLearner { agent, rule }
        });
        self.check(features, || TdLearner { agent: agent(), rule: NStepSarsa::new(4) });
        let target = TargetPolicy::Greedy;
        self.check(features, || TdLearner { agent: agent(), rule: NStepTreeBackup::new(4, target) });
        self.check(features, || TdLearner { agent: agent(), rule: NStepQSigma::new(4, 0.5, target) });
        self.check(features, || TdLearner { agent: agent(), rule: DifferentialSarsa::new(0.1) });
        self.check(features, || TdLearner { agent: agent(), rule: DifferentialQLearning::new(0.1) });
        let rule = || SarsaLambda { traces: traces(), kind, trace_decay: 0.8 };
        self.check(features, || TdLearner { agent: agent(), rule: rule() });
        let rule = || WatkinsQLambda { traces: traces(), kind, trace_decay: 0.8 };
        self.check(features, || TdLearner { agent: agent(), rule: rule() });
        if !self.visits {
            self.check(features, || TdLearner { agent: agent(), rule: TrueOnlineSarsaLambda::new(traces(), 0.8) });
            let critic = || Critic { table: zeros(), step_size: 0.1, row_step_sizes: Vec::new() };
            let actor = || Agent { policy: AnyPolicy::softmax(1.0, ACTIONS), ..agent() };
            self.check(features, || TdLearner { agent: actor(), rule: Reinforce::new(Some(critic())) });
            self.check(features, || TdLearner { agent: actor(), rule: ActorCritic::new(critic()) });
            let rule = || ActorCriticLambda::new(critic(), 0.8, &StopFlag::new()).expect("a few rows");
            self.check(features, || TdLearner { agent: actor(), rule: rule() });
        }
    }

    /// The learners that need a table, besides those that work with any features.
    fn check_tables<F: Features<[f32; 2], Active = [u32; 1]> + Clone>(&self, grid: &F) {
        let rows = grid.len();
        self.check_all(grid, 1);
        let (agent, stop) = (|| self.agent(rows, 1), StopFlag::new());
        let model = || Model::new(rows, ACTIONS, &stop).expect("a small model");
        // More planning than one call does, so that a run can stop within a step. As this is slow, only a few steps are
        // made.
        let (planner, planning) = if self.damage.is_empty() {
            (Self { limit: LIMIT / 10, steps: 1000 * self.steps, ..self.clone() }, 9000)
        } else {
            (self.clone(), 3)
        };
        planner.check(grid, || TdLearner { agent: agent(), rule: DynaQ::new(model(), planning) });
        let stochastic = || StochasticModel::new(rows, ACTIONS, &stop).expect("a small model");
        self.check(grid, || TdLearner { agent: agent(), rule: DynaQ::new(stochastic(), 5) });
        let sweeping = || PrioritizedSweeping::new(model(), planning, 1e-4, &stop).expect("a small model");
        planner.check(grid, || TdLearner { agent: agent(), rule: sweeping() });
        let pairs = rows * ACTIONS;
        for exploring_starts in [false, true] {
            let rule = || MonteCarloControl::new(pairs, LIMIT, exploring_starts, &stop).expect("a few pairs");
            self.check(grid, || TdLearner { agent: agent(), rule: rule() });
        }
        let off_policy = || OffPolicyMonteCarlo::new(pairs, LIMIT, (1.0, 0.0), &stop).expect("a few pairs");
        self.check(grid, || TdLearner { agent: agent(), rule: off_policy() });
        let dyna_q_plus = || DynaQPlus::new(model(), planning, 1e-3, &StopFlag::new()).expect("a small model");
        planner.check(grid, || TdLearner { agent: agent(), rule: dyna_q_plus() });
    }
}

fn rounding() -> impl Features<[f32; 2], Active = [u32; 1]> + Clone {
    Rounding::new([Axis::new(-1.2_f32, 0.6, 10.0), Axis::new(-0.07_f32, 0.07, 100.0)])
}

fn setup() -> impl Strategy<Value = Setup> {
    (0..EPISODES as u64 * LIMIT, any::<u32>(), any::<bool>(), any::<bool>()).prop_map(
        |(steps, seed, mt19937, visits)| Setup { steps, limit: LIMIT, seed, mt19937, visits, damage: Vec::new() },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn every_learner_on_tilings_resumes_exactly(setup in setup()) {
        let tiles: TileCoding<f32, 8> = TileCoding::new(&[-1.2, -0.07], &[0.6, 0.07], &[4, 4], 5);
        setup.check_all(&tiles, 5);
    }

    #[test]
    fn every_learner_on_a_grid_resumes_exactly(setup in setup()) {
        setup.check_tables(&rounding());
    }

    /// Even arbitrary bytes cause no panic.
    #[test]
    fn any_bytes_are_restored_or_refused(
        setup in setup(),
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
    ) {
        Setup { damage, ..setup }.check_tables(&rounding());
    }
}
