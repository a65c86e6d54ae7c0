//! A task with a given policy that reads the observations.

use super::Behavior;
use crate::checkpoint::{Checkpoint, CheckpointError};
use crate::envs::Env;
use crate::features::{ActiveFeatures, Features};
use crate::random::Rng;
use crate::tasks::{NativeTask, Next, Task, Transition};

/// A task that provides observations besides their active rows.
pub trait ObservableTask: Task {
    /// An observation.
    type Observation;

    /// The observation of a state.
    fn observation(&self, state: &Self::State) -> Self::Observation;
}

impl<E: Env<Action = usize>, F: Features<E::Observation>> ObservableTask for NativeTask<E, F> {
    type Observation = E::Observation;

    #[inline]
    fn observation(&self, state: &Self::State) -> E::Observation {
        self.env.observe(&state.state)
    }
}

/// A policy that does not change, and chooses by the observation.
pub trait ObservationPolicy<O> {
    /// The error of a failed choice.
    type Error;

    /// Samples an action A, and returns it with its importance-sampling ratio π(A|S) / b(A|S): 1 if this policy is
    /// evaluated. `active` are the active rows of the observation in the task.
    ///
    /// # Errors
    /// An exception of a policy in Python, or an observation without a row.
    fn choose(&mut self, observation: &O, active: &[u32], rng: &mut impl Rng) -> Result<(usize, f64), Self::Error>;

    /// The work of a choice, as counted by [`Budget`](crate::Budget), in addition to that of a step.
    fn work(&self) -> u64 {
        0
    }
}

/// The active rows of a state, with the action that a policy took in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WithAction<R> {
    active: R,
    action: u32,
    ratio: f64,
}

impl<R> WithAction<R> {
    fn new(active: R, (action, ratio): (usize, f64)) -> Self {
        Self { active, action: action as u32, ratio }
    }

    /// No action, as the episode is over.
    fn none(active: R) -> Self {
        Self::new(active, (0, 1.0))
    }
}

impl<R: AsRef<[u32]>> AsRef<[u32]> for WithAction<R> {
    #[inline]
    fn as_ref(&self) -> &[u32] {
        self.active.as_ref()
    }
}

impl<R: ActiveFeatures> ActiveFeatures for WithAction<R> {
    const WEIGHTED: bool = R::WEIGHTED;

    #[inline(always)]
    fn values(&self) -> &[f64] {
        self.active.values()
    }

    fn from_values(values: &[f64]) -> Option<Self> {
        R::from_values(values).map(Self::none)
    }
}

impl<'a, R: TryFrom<&'a [u32]>> TryFrom<&'a [u32]> for WithAction<R> {
    type Error = R::Error;

    fn try_from(active: &'a [u32]) -> Result<Self, R::Error> {
        active.try_into().map(Self::none)
    }
}

/// The behavior policy of a [`PolicyTask`], which has already chosen the action.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ActionFromTask;

impl<R> Behavior<WithAction<R>> for ActionFromTask {
    const OF_STATES: bool = false;

    #[inline]
    fn action(&self, _state: u32, active: &WithAction<R>, _rng: &mut impl Rng) -> usize {
        active.action as usize
    }

    #[inline]
    fn ratio(&self, _state: u32, active: &WithAction<R>, _action: usize) -> f64 {
        active.ratio
    }
}

/// A task with the policy that acts in it and the agent's generator.
///
/// The rows alone do not determine the choice of such a policy. So the task asks the policy, and passes the action with
/// the active rows to the learner, which returns it.
#[derive(Clone, Debug)]
pub struct PolicyTask<W, P, D> {
    /// The task.
    pub task: W,
    /// The policy.
    pub policy: P,
    /// The agent's generator.
    pub rng: D,
}

impl<W: ObservableTask, P: ObservationPolicy<W::Observation>, D: Rng> PolicyTask<W, P, D> {
    fn act(&mut self, state: &W::State, active: W::Active) -> Result<WithAction<W::Active>, P::Error> {
        let chosen = self.policy.choose(&self.task.observation(state), active.as_ref(), &mut self.rng)?;
        Ok(WithAction::new(active, chosen))
    }
}

impl<W, P, D> Task for PolicyTask<W, P, D>
where
    W: ObservableTask,
    P: ObservationPolicy<W::Observation, Error: From<W::Error>>,
    D: Rng,
{
    type State = W::State;
    type Active = WithAction<W::Active>;
    type Error = P::Error;

    fn reset(&mut self) -> Result<(W::State, Self::Active), P::Error> {
        let (state, active) = self.task.reset()?;
        Ok((state, self.act(&state, active)?))
    }

    fn step(&mut self, state: &mut W::State, action: usize) -> Result<Transition<Self::Active>, P::Error> {
        let Transition { reward, next } = self.task.step(state, action)?;
        let next = match next {
            Next::NonTerminal(active) => Next::NonTerminal(self.act(state, active)?),
            Next::Truncated(active) => Next::Truncated(WithAction::none(active)),
            Next::Terminal => Next::Terminal,
        };
        Ok(Transition { reward, next })
    }

    fn step_work(&self) -> u64 {
        self.task.step_work() + self.policy.work()
    }

    fn active_rows(&self, _state: &W::State) -> Result<Self::Active, P::Error> {
        unreachable!("an episode of a prediction is never resumed in the middle")
    }

    fn resumes_episodes(&self) -> bool {
        false
    }

    /// A prediction has no checkpoints.
    fn persist(&mut self, _state: Option<&mut W::State>, _: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        Err(CheckpointError::Invalid("prediction, which is not resumed"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envs::classic_control::MountainCar;
    use crate::features::{FeatureVector, FourierBasis, OutOfBounds, TileCoding};
    use crate::memory::AllocationError;
    use crate::prediction::test_support::rng;
    use crate::prediction::{LinearValues, OfflineLambdaReturn, Predictor, StateFeatures, TdZero};
    use crate::schedules::{LearningRate, Schedule};
    use crate::{Budget, Trainer};

    /// Pushes in the direction of the velocity.
    #[derive(Clone, Debug)]
    struct WithTheVelocity;

    impl ObservationPolicy<[f32; 2]> for WithTheVelocity {
        type Error = OutOfBounds;

        fn choose(
            &mut self,
            &[_, velocity]: &[f32; 2],
            _: &[u32],
            _: &mut impl Rng,
        ) -> Result<(usize, f64), OutOfBounds> {
            Ok((if velocity < 0.0 { 0 } else { 2 }, 1.0))
        }
    }

    fn task() -> PolicyTask<NativeTask<MountainCar, TileCoding<f32, 8>>, WithTheVelocity, crate::random::Pcg64> {
        let tiles = TileCoding::new(&[-1.2, -0.07], &[0.6, 0.07], &[8, 8], 8);
        let task = NativeTask::new(MountainCar::default(), tiles, Some(200), rng());
        PolicyTask { task, policy: WithTheVelocity, rng: rng() }
    }

    fn values(look_back: Option<usize>) -> Result<LinearValues, AllocationError> {
        let features = StateFeatures::of_visits(8, 8 * 81, look_back)?;
        let rate = LearningRate::scheduled(Schedule::constant(0.5), 8);
        Ok(LinearValues::new(vec![0.0; 8 * 81], features, rate, 1.0))
    }

    #[test]
    fn the_goal_is_reached_and_the_values_are_near_the_returns() {
        let monte_carlo = Box::new(OfflineLambdaReturn::monte_carlo(false, 0));
        let learner = Predictor::new(values(None).expect("memory suffices"), ActionFromTask, monte_carlo);
        let mut run = Trainer::new(task(), learner, rng());
        while run.episodes().returns.len() < 200 {
            run.advance(Budget { episodes: 200, work: 1000 }).expect("no bounds are left");
        }
        assert!(run.episodes().terminated.iter().all(|&terminated| terminated));
        let mean = run.episodes().returns.iter().sum::<f64>() / 200.0;
        let start = task().task.features.active_rows(&[-0.5_f32, 0.0]).expect("it lies in the box");
        let value: f64 = start.as_ref().iter().map(|&row| run.learner().values.weights[row as usize]).sum();
        assert!((value - mean).abs() < 15.0, "{value} for returns of {mean}");
    }

    #[test]
    fn weighted_features_stay_weighted_with_an_action() {
        type WithFeatures = WithAction<FeatureVector<4>>;
        let features = FeatureVector::<4>::new(&[1.0, 0.5]).expect("there is room");
        let with_action = WithAction::new(features, (2, 1.0));
        assert_eq!([WithFeatures::WEIGHTED, WithAction::<[u32; 1]>::WEIGHTED], [true, false]);
        assert_eq!(with_action.values(), features.values());
        assert_eq!(WithFeatures::from_values(features.values()), Some(WithAction::none(features)));
    }

    #[test]
    #[should_panic(expected = "needs binary features")]
    fn values_are_not_predicted_from_the_rows_of_weighted_features() {
        let basis =
            FourierBasis::<f32, 16>::try_new(&[-1.2, -0.07], &[0.6, 0.07], 3, true, false).expect("16 features");
        let task = NativeTask::new(MountainCar::default(), basis, Some(200), rng());
        let task = PolicyTask { task, policy: WithTheVelocity, rng: rng() };
        let values = values(None).expect("memory suffices");
        let _ = Trainer::new(task, Predictor::new(values, ActionFromTask, Box::new(TdZero)), rng()).train(1);
    }

    #[test]
    fn a_method_that_looks_back_one_step_needs_no_more_rows() {
        let weights = [Some(1), None].map(|look_back| {
            let values = values(look_back).expect("memory suffices");
            let mut run = Trainer::new(task(), Predictor::new(values, ActionFromTask, Box::new(TdZero)), rng());
            run.advance(Budget { episodes: 3, work: 1000 }).expect("no bounds are left");
            run.learner().values.weights.clone()
        });
        assert_eq!(weights[0], weights[1]);
    }

    #[test]
    fn values_of_weighted_features_do_not_depend_on_how_many_visits_are_kept() {
        let weights = [Some(1), None].map(|look_back| {
            let basis =
                FourierBasis::<f32, 16>::try_new(&[-1.2, -0.07], &[0.6, 0.07], 3, true, false).expect("16 features");
            let task = NativeTask::new(MountainCar::default(), basis, Some(200), rng());
            let task = PolicyTask { task, policy: WithTheVelocity, rng: rng() };
            let features = StateFeatures::of_weighted_visits(16, look_back).expect("memory suffices");
            let rate = LearningRate::scheduled(Schedule::constant(0.001), 1);
            let values = LinearValues::new(vec![0.0; 16], features, rate, 1.0);
            let mut run = Trainer::new(task, Predictor::new(values, ActionFromTask, Box::new(TdZero)), rng());
            run.advance(Budget { episodes: 3, work: 1000 }).expect("no bounds are left");
            run.learner().values.weights.clone()
        });
        assert_eq!(weights[0], weights[1]);
        assert!(weights[0].iter().all(|&weight| weight != 0.0));
    }
}
