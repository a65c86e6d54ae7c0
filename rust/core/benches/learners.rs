//! What each learner costs a step, on the article's grid and on eight tilings.
//!
//! `cargo bench --bench learners`, or with `-- tilings` for the tilings alone. Policies and rates are those chosen at run
//! time, the same for all.

mod valley;

use std::fmt::Debug;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput};
use qtab_core::features::{Features, Tiles};
use qtab_core::learners::{
    Agent, Behaviour, Control, DoubleQLearning, DynaQ, DynaQPlus, ExpectedSarsa, Model, NStepSarsa, QLearning, Rate,
    Rule, Sarsa, SarsaLambda, Schedule, TerminalUpdate, Ties, Trace, Traces, TrueOnlineSarsaLambda, WatkinsQLambda,
};
use qtab_core::{Learner, Table, Trainer, Until, World};
use valley::{INSIDE, Valley, rounding, world};

const EPISODES: usize = 100;
const ACTIONS: usize = 3;
const TILINGS: usize = 8;
const TRACE_DECAY: f64 = 0.9;
const CUTOFF: f64 = 1e-3;

/// Sutton & Barto's setting for the valley: values of zero are optimistic there, so that nothing need be explored.
fn agent(rows: usize, lit: usize) -> Agent {
    Agent {
        table: Table::new(vec![0.0; rows * ACTIONS], ACTIONS),
        policy: Behaviour::EpsilonGreedy { epsilon: Schedule::constant(0.0), ties: Ties::First },
        learning_rate: Rate::scheduled(Schedule::constant(0.3), lit),
        discount: 1.0,
        terminal_update: TerminalUpdate::Target,
    }
}

/// Learners over one kind of features.
struct Bench<'a, F> {
    group: BenchmarkGroup<'a, WallTime>,
    features: F,
    lit: usize,
}

impl<F> Bench<'_, F>
where
    F: Features<[f32; 2]> + Clone,
    Valley<F>: World<Rows = F::Rows, Error: Debug>,
{
    fn rule<U: Rule<F::Rows, Agent>>(&mut self, name: &str, rule: impl Fn(&Agent) -> U) {
        self.learner(name, |agent| Control { rule: rule(&agent), agent });
    }

    fn learner<L: Learner<F::Rows>>(&mut self, name: &str, learner: impl Fn(Agent) -> L) {
        let (features, lit) = (&self.features, self.lit);
        let run = || {
            let learner = learner(agent(features.len(), lit));
            let mut trainer = Trainer::new(world(features.clone()), learner, valley::agent());
            trainer.advance(Until { episodes: EPISODES, steps: u64::MAX }).expect(INSIDE);
            trainer.episodes().lengths.iter().sum::<i64>() as u64
        };
        self.group.throughput(Throughput::Elements(run()));
        self.group.bench_function(name, |bencher| bencher.iter(run));
    }

    fn all(&mut self) {
        let traces = |agent: &Agent, cutoff| Traces::new(agent.table.values().len(), cutoff);
        let (kind, trace_decay) = (Trace::Replacing, TRACE_DECAY);
        self.rule("Q-learning", |_| QLearning);
        self.rule("Sarsa", |_| Sarsa);
        self.rule("Expected Sarsa", |_| ExpectedSarsa);
        self.learner("Double Q-learning", |agent| {
            let second = agent.table.clone();
            DoubleQLearning::new(agent, second)
        });
        self.rule("4-step Sarsa", |_| NStepSarsa::new(4));
        self.rule("Sarsa(0.9)", |agent| SarsaLambda { traces: traces(agent, 0.0), kind, trace_decay });
        self.rule("Sarsa(0.9), cut off", |agent| SarsaLambda { traces: traces(agent, CUTOFF), kind, trace_decay });
        self.rule("true online Sarsa(0.9)", |agent| TrueOnlineSarsaLambda::new(traces(agent, 0.0), trace_decay));
        self.rule("Watkins's Q(0.9)", |agent| WatkinsQLambda { traces: traces(agent, 0.0), kind, trace_decay });
    }
}

fn grid(criterion: &mut Criterion) {
    let mut grid = Bench { group: criterion.benchmark_group("grid"), features: rounding(), lit: 1 };
    grid.all();
    let model = |agent: &Agent| Model::new(agent.table.values().len() / ACTIONS, ACTIONS);
    grid.rule("Dyna-Q, 10 steps planned", |agent| DynaQ { model: model(agent), planning_steps: 10 });
    grid.rule("Dyna-Q+, 10 steps planned", |agent| DynaQPlus::new(model(agent), 10, 1e-3));
    grid.group.finish();
}

fn tilings(criterion: &mut Criterion) {
    let bounds = [[-1.2_f32, -0.07], [0.6, 0.07]].map(|bound| bound.map(f64::from));
    let tiles = Tiles::<f32, TILINGS>::new(&bounds[0], &bounds[1], &[8, 8], TILINGS as u32);
    let mut tilings = Bench { group: criterion.benchmark_group("tilings"), features: tiles, lit: TILINGS };
    tilings.all();
    tilings.group.finish();
}

fn main() {
    let mut criterion = Criterion::default().configure_from_args();
    grid(&mut criterion);
    tilings(&mut criterion);
    criterion.final_summary();
}
