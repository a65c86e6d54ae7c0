//! What an environment is: frozen parameters in `self`, the state by value, the draws passed in.

use crate::random::Draw;

/// What one step brings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step<S> {
    /// The state after the step.
    pub state: S,
    /// The reward of the step.
    pub reward: f64,
    /// Whether the state after the step is terminal (a time-out is not the environment's to say).
    pub terminated: bool,
}

/// An environment: physics without a clock, a renderer or a generator of its own.
pub trait Env {
    /// All that changes from step to step.
    type State: Copy;
    /// What `step` takes: an index for discrete actions.
    type Action: Copy;
    /// What the agent sees, in the dtype in which Gymnasium hands it out.
    type Observation;

    /// How many actions there are; 0 where they are continuous.
    fn actions(&self) -> usize;

    /// The first state of an episode.
    fn reset(&self, draw: &mut impl Draw) -> Self::State;

    /// The two numbers between which first states lie, under the names of Gymnasium's reset options.
    const START: Option<[(&'static str, f64); 2]> = None;

    /// The first state of an episode between other numbers than `START`'s; where it has none, any first state.
    fn reset_between(&self, _start: [f64; 2], draw: &mut impl Draw) -> Self::State {
        self.reset(draw)
    }

    /// One step of the dynamics.
    ///
    /// # Panics
    /// It may, where the action is none of the environment's: whoever takes actions from outside checks them.
    fn step(&self, state: Self::State, action: Self::Action, draw: &mut impl Draw) -> Step<Self::State>;

    /// One step in each of several lanes: its state moves on, its reward and its end are put in their places. Those that
    /// are `idle` keep their states, whatever their actions are. It may be computed in another way where wide registers
    /// pay, never with other results than `step`'s.
    #[inline]
    fn step_lanes(
        &self,
        states: &mut [Self::State],
        actions: &[Self::Action],
        draws: &mut [impl Draw],
        rewards: &mut [f64],
        terminated: &mut [bool],
        idle: &[bool],
    ) {
        let places = rewards.iter_mut().zip(terminated).zip(idle);
        for (((state, &action), draw), ((reward, end), &idle)) in states.iter_mut().zip(actions).zip(draws).zip(places)
        {
            if !idle {
                let step = self.step(*state, action, draw);
                (*state, *reward, *end) = (step.state, step.reward, step.terminated);
            }
        }
    }

    /// What the agent sees of a state.
    fn observe(&self, state: &Self::State) -> Self::Observation;
}

/// A constant that is one thing or the other, under Gymnasium's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Switch {
    /// The name, as Gymnasium spells the attribute.
    pub name: &'static str,
    /// The word that turns it on; None where the attribute is a truth value.
    pub word: Option<&'static str>,
}

/// The constants of an environment by Gymnasium's names, for those who know them at run time only.
pub trait Parameters: Default {
    /// The names of the numbers, as Gymnasium spells its attributes.
    const NAMES: &'static [&'static str];
    /// What is no number.
    const SWITCHES: &'static [Switch] = &[];

    /// The number of that name.
    fn parameter(&mut self, name: &str) -> Option<&mut f64>;

    /// The switch of that name.
    fn switch(&mut self, _name: &str) -> Option<&mut bool> {
        None
    }
}
