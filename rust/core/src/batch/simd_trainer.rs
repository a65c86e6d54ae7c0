//! The type of the runs that can be trained in a batch.

use crate::learners::{Agent, QLearning, TdLearner};
use crate::policies::EpsilonGreedy;
use crate::random::Pcg64;
use crate::tasks::NativeTask;
use crate::trainer::Trainer;

/// ε-greedy Q-learning with `N` actions. It can be trained in a batch if its environment `E` steps in SIMD lanes and its
/// features `F` are a grid; see [`BatchedRun`](super::BatchedRun).
pub type SimdTrainer<E, F, const N: usize, A> =
    Trainer<NativeTask<E, F>, TdLearner<QLearning, Agent<N, EpsilonGreedy, A>>, Pcg64>;
