//! The training loop, compiled for wide vector registers too where a learner or a task has use for them.

#![expect(clippy::inline_always, reason = "code compiled per instruction set must be inlined into its dispatcher")]

use super::{Budget, Trainer};
use crate::learners::Learner;
use crate::numeric::{SimdCode, SimdLevel};
use crate::random::Rng;
use crate::tasks::Task;

/// A run and its budget, compiled for each [`SimdLevel`].
pub(super) struct AdvanceLoop<'a, T: Task, L, R> {
    pub(super) trainer: &'a mut Trainer<T, L, R>,
    pub(super) rng: &'a mut R,
    pub(super) budget: Budget,
}

impl<T: Task, L: Learner<T::Active>, R: Rng + Clone> AdvanceLoop<'_, T, L, R> {
    /// Runs the loop with the machine's instructions. The results are the same with all of them: no multiplication is fused
    /// with an addition.
    #[inline(always)]
    pub(super) fn dispatch(self) -> Result<(), T::Error> {
        let level = if L::HAS_VECTOR_PASSES || T::USES_VECTORS { SimdLevel::detect() } else { SimdLevel::PLAIN };
        level.run(self)
    }
}

impl<T: Task, L: Learner<T::Active>, R: Rng + Clone> SimdCode for AdvanceLoop<'_, T, L, R> {
    type Output = Result<(), T::Error>;

    #[inline(always)]
    fn run<const FUSED: bool>(self) -> Self::Output {
        self.trainer.advance_with(self.rng, self.budget)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envs::classic_control::MountainCar;
    use crate::features::{FixedTileCoding, TileCoding};
    use crate::learners::{Agent, SarsaLambda, TdLearner, TraceKind, Traces, TrueOnlineSarsaLambda, UpdateRule};
    use crate::policies::{AnyPolicy, TieBreaking};
    use crate::q_table::{QTable, TerminalUpdate};
    use crate::random::{Pcg64, SeedSequence};
    use crate::schedules::{LearningRate, Schedule};
    use crate::stop_flag::StopFlag;
    use crate::tasks::NativeTask;

    const WEIGHTS: usize = 8 * 9 * 9 * 3;

    /// Runs an update rule with the machine's instructions and with those that every machine has.
    fn check<U>(rule: U)
    where
        U: UpdateRule<<FixedTileCoding<f32, 2, 8> as crate::Features<[f32; 2]>>::Active, Agent> + Clone,
    {
        let seed = SeedSequence::new(&[3]);
        let bounds = [[-1.2_f32, -0.07], [0.6, 0.07]].map(|bound| bound.map(f64::from));
        let tiles = TileCoding::<f32, 8>::new(&bounds[0], &bounds[1], &[8, 8], 8);
        let features = FixedTileCoding::<f32, 2, 8>::new(&tiles).expect("the numbers agree");
        let task = NativeTask::new(MountainCar::default(), features, Some(100), Pcg64::new(&seed));
        let agent = Agent {
            table: QTable::new(vec![0.0; WEIGHTS], 3),
            policy: AnyPolicy::EpsilonGreedy { epsilon: Schedule::constant(0.1), ties: TieBreaking::First },
            learning_rate: LearningRate::scheduled(Schedule::constant(0.3), 8),
            discount: 0.99,
            terminal_update: TerminalUpdate::Target,
            masks: None,
        };
        let mut wide = Trainer::new(task, TdLearner { agent, rule }, Pcg64::new(&seed));
        let mut narrow = wide.clone();
        let budget = Budget { episodes: 20, work: u64::MAX };
        wide.advance(budget).expect("no bounds are left");
        narrow.reserve(budget).expect("a few episodes");
        let mut rng = narrow.rng.clone();
        narrow.advance_with(&mut rng, budget).expect("no bounds are left");
        assert_eq!(wide.episodes(), narrow.episodes());
        let bits = |table: &QTable| table.values().iter().map(|value| value.to_bits()).collect::<Vec<_>>();
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
}
