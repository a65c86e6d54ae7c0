//! Runs that take turns on one core: while one waits for its chain of operations, others go on.
//!
//! A lone run is bound by latency, the cosine's above all, and by branches that nobody can predict. Side by side, the
//! physics of several runs is computed in the processor's wide registers, what an agent explores is chosen without a
//! branch, and the chains overlap. The results are the lone run's to the bit.

#![expect(clippy::inline_always, reason = "what is compiled for each instruction set must be inlined to be so")]
#![expect(clippy::needless_bitwise_bool, reason = "a lazy operator would be a branch that nobody can predict")]

mod lanes;
#[cfg(test)]
mod tests;
mod words;

use crate::Env;
use crate::envs::{CartPole, MountainCar, Wide};
use crate::features::{Axis, Bins, Edges, Features, Lanes, Outside, Rounding};
use crate::learners::{Agent, Control, EpsilonGreedy, QLearning, Schedule, StepSize};
use crate::random::Pcg64;
use crate::trainer::{Trainer, Until};
use crate::worlds::Native;

/// How many runs go together best.
pub const LANES: usize = 8;

/// Rewards of at most 1 a step never bring a value from here to infinity: nobody need look whether a run diverges.
const FAR_FROM_OVERFLOW: f64 = 1e300;

/// Q-learning of `N` actions, ε-greedy, in wide physics on a grid.
pub type Turned<E, F, const N: usize, A> = Trainer<Native<E, F>, Control<QLearning, Agent<N, EpsilonGreedy, A>>, Pcg64>;

/// The article's run.
pub type Article = Turned<MountainCar, Rounding<f32, [Axis<f32>; 2]>, 3, f64>;

/// The poles' run: bins, and a learning rate that falls.
pub type Balance = Turned<CartPole, Bins<f32, [Edges; 4]>, 2, Schedule>;

/// Runs that a batch is made for.
pub trait Batch: Sized {
    /// Advances every run by up to `until.steps` steps, until one of them has `until.episodes`. Each is then where it
    /// would be had it advanced alone by as many steps, and may go on with others, or alone.
    ///
    /// Runs that do not differ in their seeds, tables and rates alone, or that come to an observation without a row,
    /// advance one after the other.
    ///
    /// # Errors
    /// As for [`Trainer::advance`], with the index of the run that failed; the others may go on.
    fn advance_all<const K: usize>(runs: &mut [Self; K], until: Until) -> Result<(), (usize, Outside)>;
}

impl<E, F, A, const N: usize, const M: usize> Batch for Turned<E, F, N, A>
where
    E: Wide<M> + Env<Observation = [f32; M]>,
    F: Lanes<M>,
    A: StepSize,
{
    fn advance_all<const K: usize>(runs: &mut [Self; K], until: Until) -> Result<(), (usize, Outside)> {
        if runs.iter().any(|run| run.episodes.returns.len() >= until.episodes) {
            return Ok(());
        }
        let mut steps = until.steps;
        if runs[0].world.env.trusted() && runs.iter().all(|run| alike(run, &runs[0])) {
            steps = pulp::Arch::new().dispatch(lanes::Turns { runs, until })?;
        }
        let mut lanes = runs.iter_mut().enumerate();
        lanes.try_for_each(|(lane, run)| run.advance(Until { steps, ..until }).map_err(|outside| (lane, outside)))
    }
}

fn alike<E, F, A, const N: usize>(one: &Turned<E, F, N, A>, other: &Turned<E, F, N, A>) -> bool
where
    E: Env<Action = usize> + PartialEq,
    F: Features<E::Observation> + PartialEq,
{
    let (world, agent) = (&one.world, &one.learner.agent);
    let others = &other.learner.agent;
    world.env == other.world.env
        && world.features == other.world.features
        && world.max_episode_steps == other.world.max_episode_steps
        && agent.discount == others.discount
        && agent.terminal_update == others.terminal_update
        && agent.table.values().len() == others.table.values().len()
        && agent.table.values().iter().all(|value| value.abs() < FAR_FROM_OVERFLOW)
}
