#![doc = include_str!("../README.md")]
//!
//! # The parts
//!
//! An [`Env`] holds frozen parameters and passes its state by value. [`Features`] turn an observation into the active
//! rows of a Q table. A [`Task`] combines both with a time limit; it is what a learner interacts with. A [`Learner`]
//! owns its table, its policy and its schedules. A [`Trainer`] holds a task, a learner and a random generator, and
//! [`Trainer::advance`] is the only training loop. [`TrainerBuilder`] makes a trainer of any algorithm.
//!
//! | to find | look in |
//! |---|---|
//! | environments: Gymnasium's, and transition tables | [`envs`] |
//! | grids, tiles, indices | [`features`] |
//! | the algorithms, and their options | [`learners`], [`AnyAlgorithm`](learners::AnyAlgorithm) |
//! | exploration, and the greedy policy | [`policies`], [`PolicySpec`](settings::PolicySpec) |
//! | optimal policies | [`planning`] |
//! | the values of a given policy | [`prediction`] |
//! | tasks with visit counts, recordings, or the time in the state | [`tasks`] |
//! | many runs at once; vector environments | [`batch`], [`vector`] |
//!
//! # The fast way
//!
//! Here the rule, the policy, the learning rate and the number of actions are types, which the compiler optimizes
//! together with the environment. These are the settings of "the article", G. Hayes, *Getting Started with Reinforcement
//! Learning and Open AI Gym*, 2019, a widely read introduction to Q-learning on `MountainCar`.
//!
//! ```
//! use qtab_core::envs::classic_control::MountainCar;
//! use qtab_core::features::{Axis, Rounding};
//! use qtab_core::learners::{Agent, QLearning, TdLearner};
//! use qtab_core::policies::EpsilonGreedy;
//! use qtab_core::q_table::TerminalUpdate;
//! use qtab_core::random::{AgentRng, Pcg64, SeedSequence};
//! use qtab_core::tasks::NativeTask;
//! use qtab_core::{QTable, Trainer};
//!
//! let seed = SeedSequence::from(0);
//! let mut rng = AgentRng::pcg64(&seed);
//! let rounding = Rounding::new([Axis::new(-1.2_f32, 0.6, 10.0), Axis::new(-0.07_f32, 0.07, 100.0)]);
//! let task = NativeTask::new(MountainCar::default(), rounding, Some(200), Pcg64::new(&seed));
//! let agent = Agent {
//!     table: QTable::<3>::uniform(19 * 15, 3, -1.0, 1.0, &mut rng),
//!     policy: EpsilonGreedy::linear(0.8, 0.0, 5000),
//!     learning_rate: 0.2, // one active row; several would share it
//!     discount: 0.9,
//!     terminal_update: TerminalUpdate::Assign,
//!     masks: None,
//! };
//! let mut trainer = Trainer::try_new(task, TdLearner { agent, rule: QLearning }, rng)?;
//! assert_eq!(trainer.train(100)?.len(), 100);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![forbid(unsafe_code)]
#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

pub mod batch;
pub mod checkpoint;
pub mod envs;
mod errors;
pub mod features;
pub mod learners;
pub mod memory;
pub mod numeric;
pub mod planning;
pub mod policies;
pub mod prediction;
pub mod q_table;
pub mod random;
pub mod schedules;
pub mod settings;
pub mod simd;
mod stop_flag;
pub mod tasks;
mod trainer;
pub mod vector;

pub use envs::Env;
pub use errors::{BuildError, TrainingError};
pub use features::Features;
pub use learners::Learner;
pub use q_table::QTable;
pub use rand_core;
pub use stop_flag::StopFlag;
pub use tasks::Task;
pub use trainer::{AnyTrainer, Budget, EpisodeLog, EvaluationError, LoadError, Trainer, TrainerBuilder, evaluate};
pub use vector::VectorEnv;
