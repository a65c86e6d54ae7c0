//! Tabular reinforcement learning with the numbers of Gymnasium and `NumPy`, bit for bit.
//!
//! An [`Env`] is physics: frozen parameters, and a state passed by value. [`Features`] turn an observation into rows of
//! a table. A [`World`] is what a learner meets: both together, with a time limit. A [`Learner`] owns its table, its
//! policy and its schedules. A [`Trainer`] holds a world, a learner and a stream, and [`Trainer::advance`] is the only
//! loop there is.
//!
//! ```
//! use qtab_core::envs::MountainCar;
//! use qtab_core::features::{Axis, Rounding};
//! use qtab_core::learners::{Agent, Control, EpsilonGreedy, QLearning, TerminalUpdate};
//! use qtab_core::random::{Pcg64, SeedSequence, Stream};
//! use qtab_core::worlds::Native;
//! use qtab_core::{Table, Trainer, Until};
//!
//! let seed = SeedSequence::new(&[0]);
//! let mut draw = Stream::pcg64(&seed);
//! let rounding = Rounding::new([Axis::new(-1.2_f32, 0.6, 10.0), Axis::new(-0.07_f32, 0.07, 100.0)]);
//! let world = Native::new(MountainCar::default(), rounding, Some(200), Pcg64::new(&seed));
//! let agent = Agent {
//!     table: Table::<3>::uniform(19 * 15, 3, -1.0, 1.0, &mut draw),
//!     policy: EpsilonGreedy::linear(0.8, 0.0, 5000),
//!     learning_rate: 0.2,
//!     discount: 0.9,
//!     terminal_update: TerminalUpdate::Assign,
//! };
//! let mut trainer = Trainer::new(world, Control { agent, rule: QLearning }, draw);
//! trainer.advance(Until { episodes: 100, steps: u64::MAX }).unwrap();
//! assert_eq!(trainer.episodes().returns.len(), 100);
//! ```

pub mod batch;
mod cosine;
pub mod env;
pub mod envs;
pub mod features;
mod hint;
pub mod learner;
pub mod learners;
pub mod planning;
pub mod random;
mod table;
mod trainer;
pub mod vector;
pub mod world;
pub mod worlds;

pub use env::Env;
pub use features::Features;
pub use learner::Learner;
pub use table::Table;
pub use trainer::{Episodes, Trainer, Until};
pub use vector::Vector;
pub use world::World;
