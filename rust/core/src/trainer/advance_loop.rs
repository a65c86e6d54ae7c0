//! The training loop, compiled for wide vector registers too if the learner, the task or its features benefit from them.

use super::{Budget, Trainer};
use crate::features::ActiveFeatures;
use crate::learners::Learner;
use crate::random::Rng;
use crate::simd::{Simd, SimdCode, SimdLevel};
use crate::tasks::Task;

/// A run and its budget, compiled for each [`SimdLevel`].
pub(super) struct AdvanceLoop<'a, T: Task, L, R> {
    pub(super) trainer: &'a mut Trainer<T, L, R>,
    pub(super) rng: &'a mut R,
    pub(super) budget: Budget,
}

impl<T: Task, L: Learner<T::Active>, R: Rng + Clone> AdvanceLoop<'_, T, L, R> {
    /// Runs the loop with the widest instructions of the machine. The results do not depend on them, because
    /// multiplications and additions are never fused.
    #[inline(always)]
    pub(super) fn dispatch(self) -> Result<(), T::Error> {
        let uses_vectors = L::HAS_VECTOR_PASSES || T::USES_VECTORS || T::Active::WEIGHTED;
        let level = if uses_vectors { SimdLevel::detect() } else { SimdLevel::PLAIN };
        level.run(self)
    }
}

impl<T: Task, L: Learner<T::Active>, R: Rng + Clone> SimdCode for AdvanceLoop<'_, T, L, R> {
    type Output = Result<(), T::Error>;

    #[inline(always)]
    fn run<S: Simd>(self, _simd: S) -> Self::Output {
        if T::Active::WEIGHTED {
            self.trainer.advance_borrowed(self.rng, self.budget)
        } else {
            self.trainer.advance_with(self.rng, self.budget)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envs::classic_control::MountainCar;
    use crate::features::{Features, FixedTileCoding, OutOfBounds, TileCoding};
    use crate::learners::{Agent, SarsaLambda, TdLearner, TraceKind, Traces, TrueOnlineSarsaLambda, UpdateRule};
    use crate::policies::{AnyPolicy, TieBreaking};
    use crate::q_table::{QTable, TerminalUpdate};
    use crate::random::{Pcg64, SeedSequence};
    use crate::schedules::{LearningRate, Schedule};
    use crate::stop_flag::StopFlag;
    use crate::tasks::{BoxedTask, NativeTask, VisitCounter};

    const ROWS: usize = 9 * 9;
    const WEIGHTS: usize = 8 * ROWS * 3;

    type Tilings<const N: usize> = FixedTileCoding<f32, 2, N>;
    type ActiveTiles<const N: usize> = <Tilings<N> as Features<[f32; 2]>>::Active;

    fn task<const N: usize>() -> NativeTask<MountainCar, Tilings<N>> {
        let bounds = [[-1.2_f32, -0.07], [0.6, 0.07]].map(|bound| bound.map(f64::from));
        let tiles = TileCoding::<f32, N>::new(&bounds[0], &bounds[1], &[8, 8], N as u32);
        let features = FixedTileCoding::new(&tiles).expect("the numbers of tilings and components match");
        NativeTask::new(MountainCar::default(), features, Some(100), Pcg64::new(&SeedSequence::new(&[3])))
    }

    fn agent(tilings: usize) -> Agent {
        Agent {
            table: QTable::new(vec![0.0; tilings * ROWS * 3], 3),
            policy: AnyPolicy::EpsilonGreedy { epsilon: Schedule::constant(0.1), ties: TieBreaking::First },
            learning_rate: LearningRate::scheduled(Schedule::constant(0.3), tilings),
            discount: 0.99,
            terminal_update: TerminalUpdate::Target,
            masks: None,
        }
    }

    fn bits(table: &QTable) -> Vec<u64> {
        table.values().iter().map(|value| value.to_bits()).collect()
    }

    /// Runs an update rule with the machine's instructions and with those available on every machine.
    fn check<U>(rule: U)
    where
        U: UpdateRule<ActiveTiles<8>, Agent> + Clone,
    {
        let learner = TdLearner { agent: agent(8), rule };
        let mut wide = Trainer::new(task::<8>(), learner, Pcg64::new(&SeedSequence::new(&[3])));
        let mut narrow = wide.clone();
        let budget = Budget { episodes: 20, work: u64::MAX };
        wide.advance(budget).expect("no observation is out of bounds");
        narrow.reserve(budget).expect("a few episodes");
        let mut rng = narrow.rng.clone();
        narrow.advance_with(&mut rng, budget).expect("no observation is out of bounds");
        assert_eq!(wide.episodes(), narrow.episodes());
        assert_eq!(bits(&wide.learner().agent.table), bits(&narrow.learner().agent.table));
    }

    #[test]
    fn every_instruction_set_has_the_same_results() {
        for cutoff in [0.0, 1e-3] {
            let traces = || Traces::new(WEIGHTS, cutoff, &StopFlag::new()).expect("a few weights");
            for kind in [TraceKind::Accumulating, TraceKind::Replacing, TraceKind::Clearing] {
                check(SarsaLambda { traces: traces(), kind, trace_decay: 0.9 });
            }
            check(TrueOnlineSarsaLambda::new(traces(), 0.9));
        }
    }

    /// Sarsa(λ) in parts of this much work, until the run is finished.
    fn train<T: Task<Error = OutOfBounds>>(task: T, tilings: usize, work: u64) -> (Vec<u64>, Vec<i64>) {
        let traces = Traces::new(tilings * ROWS * 3, 1e-3, &StopFlag::new()).expect("a few weights");
        let rule = SarsaLambda { traces, kind: TraceKind::Replacing, trace_decay: 0.9 };
        let learner = TdLearner { agent: agent(tilings), rule };
        let mut trainer = Trainer::new(task, learner, Pcg64::new(&SeedSequence::new(&[3])));
        while trainer.episodes().lengths.len() < 10 {
            trainer.advance(Budget { episodes: 10, work }).expect("no observation is out of bounds");
        }
        (bits(&trainer.learner().agent.table), trainer.take_episodes().lengths)
    }

    fn check_boxed<const N: usize>() {
        let wrapped = VisitCounter::new(task::<N>(), N * ROWS, 3, &StopFlag::new()).expect("a few counts");
        let expected = train(wrapped, N, u64::MAX);
        for work in [7, 500, u64::MAX] {
            assert_eq!(train(task::<N>(), N, work), expected);
            let boxed: BoxedTask<ActiveTiles<N>, OutOfBounds> = BoxedTask::new(task::<N>());
            assert_eq!(train(boxed, N, work), expected);
        }
    }

    #[test]
    fn a_boxed_or_wrapped_task_has_the_same_steps() {
        check_boxed::<8>();
        check_boxed::<16>();
    }
}
