//! The macro that forwards the methods of a learner to a wrapped learner.

/// Implements the methods of [`Learner`](crate::Learner) by forwarding to the learner inside a type. To be used in
/// the type's `impl Learner<R>`.
///
/// `$pattern` matches the type and binds `$learner`: a wrapper has one such pattern, an enum one for each variant.
/// `rest` leaves out the methods that a wrapper may change, `learn`, `learn_borrowed`, `resume`, `end_episode` and
/// `persist`; `all` includes them.
///
/// ```
/// use qtab_core::learners::{Learner, QLearning, Sarsa, TdLearner};
/// use qtab_core::{checkpoint, delegate_learner, memory, random, tasks};
///
/// enum Either {
///     QLearning(TdLearner<QLearning>),
///     Sarsa(TdLearner<Sarsa>),
/// }
///
/// impl Learner<[u32; 1]> for Either {
///     delegate_learner!(all [u32; 1], learner in Self::QLearning(learner), Self::Sarsa(learner));
/// }
/// ```
#[macro_export]
macro_rules! delegate_learner {
    (rest $active:ty, $learner:ident in $($pattern:pat),+) => {
        #[inline]
        fn first_action(&mut self, state: $active, rng: &mut impl $crate::random::Rng) -> usize {
            match self { $($pattern => $crate::Learner::<$active>::first_action($learner, state, rng)),+ }
        }

        #[inline]
        fn set_action_mask(&mut self, state: $active, mask: &[bool]) {
            match self { $($pattern => $crate::Learner::<$active>::set_action_mask($learner, state, mask)),+ }
        }

        fn action_masks(&self) -> Option<&[bool]> {
            match self { $($pattern => $crate::Learner::<$active>::action_masks($learner)),+ }
        }

        #[inline]
        fn work(&self) -> u64 {
            match self { $($pattern => $crate::Learner::<$active>::work($learner)),+ }
        }

        fn reserve(&mut self, work: u64, memory: &mut $crate::memory::RunMemory) -> Result<(), $crate::memory::AllocationError> {
            match self { $($pattern => $crate::Learner::<$active>::reserve($learner, work, memory)),+ }
        }

        #[inline]
        fn is_unfinished(&self) -> bool {
            match self { $($pattern => $crate::Learner::<$active>::is_unfinished($learner)),+ }
        }

        fn planning_updates(&self) -> Option<u64> {
            match self { $($pattern => $crate::Learner::<$active>::planning_updates($learner)),+ }
        }

        fn average_reward(&self) -> Option<f64> {
            match self { $($pattern => $crate::Learner::<$active>::average_reward($learner)),+ }
        }

        fn complete_tables(&mut self) {
            match self { $($pattern => $crate::Learner::<$active>::complete_tables($learner)),+ }
        }

        fn tables(&self) -> Vec<&[f64]> {
            match self { $($pattern => $crate::Learner::<$active>::tables($learner)),+ }
        }

        fn policy_tables(&self) -> Vec<&[f64]> {
            match self { $($pattern => $crate::Learner::<$active>::policy_tables($learner)),+ }
        }

        fn tables_mut(&mut self) -> Vec<&mut [f64]> {
            match self { $($pattern => $crate::Learner::<$active>::tables_mut($learner)),+ }
        }

        fn shape(&self) -> (usize, usize) {
            match self { $($pattern => $crate::Learner::<$active>::shape($learner)),+ }
        }

        fn abandon_episode(&mut self) {
            match self { $($pattern => $crate::Learner::<$active>::abandon_episode($learner)),+ }
        }

        fn diverged(&self) -> bool {
            match self { $($pattern => $crate::Learner::<$active>::diverged($learner)),+ }
        }
    };
    (all $active:ty, $learner:ident in $($pattern:pat),+) => {
        $crate::delegate_learner!(rest $active, $learner in $($pattern),+);

        #[inline]
        fn learn(
            &mut self,
            state: $active,
            action: usize,
            reward: f64,
            next: $crate::tasks::Next<$active>,
            rng: &mut impl $crate::random::Rng,
        ) -> usize {
            match self { $($pattern => $crate::Learner::<$active>::learn($learner, state, action, reward, next, rng)),+ }
        }

        #[inline]
        fn learn_borrowed(
            &mut self,
            state: &$active,
            action: usize,
            reward: f64,
            next: $crate::tasks::Next<&$active>,
            rng: &mut impl $crate::random::Rng,
        ) -> usize {
            match self {
                $($pattern => $crate::Learner::<$active>::learn_borrowed($learner, state, action, reward, next, rng)),+
            }
        }

        fn resume(&mut self, next: $crate::tasks::Next<$active>, rng: &mut impl $crate::random::Rng) -> usize {
            match self { $($pattern => $crate::Learner::<$active>::resume($learner, next, rng)),+ }
        }

        fn end_episode(&mut self) {
            match self { $($pattern => $crate::Learner::<$active>::end_episode($learner)),+ }
        }

        fn persist(
            &mut self,
            checkpoint: &mut $crate::checkpoint::Checkpoint<'_>,
        ) -> Result<(), $crate::checkpoint::CheckpointError> {
            match self { $($pattern => $crate::Learner::<$active>::persist($learner, checkpoint)),+ }
        }
    };
}
