//! The type of the runs that can be trained in a batch.

use crate::learners::{Agent, TdLearner};
use crate::policies::EpsilonGreedy;
use crate::random::Pcg64;
use crate::tasks::NativeTask;
use crate::trainer::Trainer;

/// An ε-greedy one-step learner with `N` actions. It can be trained in a batch if its update rule `U` is a
/// [`BatchRule`](super::BatchRule), its environment `E` steps in SIMD lanes and its features `F` are
/// [`BatchFeatures`](crate::features::BatchFeatures).
pub type SimdTrainer<E, F, const N: usize, A, U> =
    Trainer<NativeTask<E, F>, TdLearner<U, Agent<N, EpsilonGreedy, A>>, Pcg64>;
