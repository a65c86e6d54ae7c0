//! The loop over the lanes of a batch.

use std::hint::select_unpredictable;

use super::Turned;
use super::words::Words;
use crate::Env;
use crate::envs::Wide;
use crate::envs::wide::{get, put};
use crate::features::{self, Outside};
use crate::hint::seldom;
use crate::learners::{Agent, StepSize, TerminalUpdate};
use crate::trainer::{Underway, Until};
use crate::worlds::Position;

/// Runs that are alike, and how far to go; compiled for each instruction set.
pub(super) struct Turns<'a, R, const K: usize> {
    pub(super) runs: &'a mut [R; K],
    pub(super) until: Until,
}

impl<E, F, A, const N: usize, const M: usize, const K: usize> pulp::NullaryFnOnce for Turns<'_, Turned<E, F, N, A>, K>
where
    E: Wide<M> + Env<Observation = [f32; M]>,
    F: features::Lanes<M>,
    A: StepSize,
{
    /// How many steps are left to be taken alone, because the next leads a run to an observation without a row.
    type Output = Result<u64, (usize, Outside)>;

    #[inline(always)]
    fn call(self) -> Self::Output {
        let Self { runs, until } = self;
        let mut words = runs.each_ref().map(|run| Words::new(&run.draw));
        let result = turns(runs, &mut words, until);
        for (run, words) in runs.iter_mut().zip(words) {
            run.draw = words.stream();
        }
        result
    }
}

#[inline(always)]
fn turns<E, F, A, const N: usize, const M: usize, const K: usize>(
    runs: &mut [Turned<E, F, N, A>; K],
    words: &mut [Words; K],
    until: Until,
) -> Result<u64, (usize, Outside)>
where
    E: Wide<M> + Env<Observation = [f32; M]>,
    F: features::Lanes<M>,
    A: StepSize,
{
    let mut lanes = Lanes::<M, K>::begin(runs, words)?;
    let env = runs[0].world.env;
    let features = runs[0].world.features.clone();
    let limit = runs[0].world.max_episode_steps;
    let Agent { discount, terminal_update, .. } = runs[0].learner.agent;
    let mut result = Ok(0);
    let mut on = true;
    let mut steps = until.steps;
    while on && steps > 0 {
        let before = lanes.fields;
        let terminal = env.step_fields(&mut lanes.fields, &lanes.action);
        let Some(rows) = features.rows_of_lanes(&lanes.fields.map(|field| field.map(|number| number as f32))) else {
            lanes.fields = before;
            result = Ok(steps);
            break;
        };
        steps -= 1;
        let places = rows.map(|row| row * N);
        let mut over = [false; K];
        let mut any = false;
        for lane in 0..K {
            lanes.elapsed[lane] += 1;
            lanes.total[lane] += env.reward(terminal[lane]);
            over[lane] = terminal[lane] | (lanes.elapsed[lane] >= limit);
            any |= over[lane];
        }
        for lane in 0..K {
            let agent = &mut runs[lane].learner.agent;
            let (here, there) = (lanes.place[lane] + lanes.action[lane], places[lane]);
            agent.learning_rate.visit(here);
            let learning_rate = agent.learning_rate.at(here);
            let values = agent.table.values_mut();
            let value = values[here];
            if terminal[lane] {
                seldom();
                let reward = env.reward(true);
                values[here] = match terminal_update {
                    TerminalUpdate::Assign => reward,
                    TerminalUpdate::Target => value + learning_rate * (reward - value),
                };
                continue;
            }
            let (_, largest) = best::<N>(values, there);
            values[here] = value + learning_rate * ((env.reward(false) + discount * largest) - value);
            if over[lane] {
                seldom();
                continue;
            }
            let (greedy, _) = best::<N>(values, there);
            let (explores, any) = words[lane].explore(lanes.greedy[lane], N as u32);
            lanes.action[lane] = select_unpredictable(explores, any as usize, greedy);
            lanes.place[lane] = there;
        }
        if any {
            for lane in (0..K).filter(|&lane| over[lane]) {
                let run = &mut runs[lane];
                run.finish(lanes.total[lane], lanes.elapsed[lane].cast_signed(), terminal[lane]);
                lanes.underway[lane] = false;
                on &= run.episodes.returns.len() < until.episodes;
                if !on {
                    continue;
                }
                match run.begin(&mut words[lane]) {
                    Ok(now) => lanes.put(lane, &now, run),
                    Err(outside) => {
                        result = Err((lane, outside));
                        on = false;
                    }
                }
            }
        }
    }
    for (lane, run) in runs.iter_mut().enumerate() {
        run.underway = lanes.get::<E::State, N>(lane);
    }
    result
}

/// Where the episodes of the lanes stand, field by field, as wide registers want it.
struct Lanes<const M: usize, const K: usize> {
    underway: [bool; K],
    fields: [[f64; K]; M],
    elapsed: [u64; K],
    /// Where the current row begins in its table.
    place: [usize; K],
    action: [usize; K],
    total: [f64; K],
    /// A draw below this is greedy.
    greedy: [f64; K],
}

type Now<S> = Underway<Position<S>, [u32; 1]>;

impl<const M: usize, const K: usize> Lanes<M, K> {
    /// Goes on with each run's episode, or begins one.
    fn begin<E, F, A, const N: usize>(
        runs: &mut [Turned<E, F, N, A>; K],
        words: &mut [Words; K],
    ) -> Result<Self, (usize, Outside)>
    where
        E: Wide<M>,
        F: features::Lanes<M>,
        A: StepSize,
    {
        for (lane, (run, words)) in runs.iter_mut().zip(words).enumerate() {
            if run.underway.is_none() {
                run.underway = Some(run.begin(words).map_err(|outside| (lane, outside))?);
            }
        }
        let mut lanes = Self {
            underway: [false; K],
            fields: [[0.0; K]; M],
            elapsed: [0; K],
            place: [0; K],
            action: [0; K],
            total: [0.0; K],
            greedy: [0.0; K],
        };
        for (lane, run) in runs.iter_mut().enumerate() {
            if let Some(now) = run.underway.take() {
                lanes.put(lane, &now, run);
            }
        }
        Ok(lanes)
    }

    fn put<E, F, A, const N: usize>(&mut self, lane: usize, now: &Now<E::State>, run: &Turned<E, F, N, A>)
    where
        E: Wide<M>,
        F: features::Lanes<M>,
    {
        self.underway[lane] = true;
        put(&mut self.fields, lane, now.state.state);
        self.elapsed[lane] = now.state.elapsed;
        self.place[lane] = now.here[0] as usize * N;
        self.action[lane] = now.action;
        self.total[lane] = now.total;
        self.greedy[lane] = 1.0 - run.learner.agent.policy.epsilon();
    }

    fn get<S: From<[f64; M]>, const N: usize>(&self, lane: usize) -> Option<Now<S>> {
        self.underway[lane].then(|| Underway {
            state: Position { state: get(&self.fields, lane), elapsed: self.elapsed[lane] },
            here: [(self.place[lane] / N) as u32],
            action: self.action[lane],
            total: self.total[lane],
            length: self.elapsed[lane].cast_signed(),
        })
    }
}

/// The first of the largest values of a row, and that value, without a branch.
#[inline(always)]
fn best<const N: usize>(values: &[f64], place: usize) -> (usize, f64) {
    let row = &values[place..][..N];
    let (mut best, mut largest) = (0, row[0]);
    for (action, &value) in row.iter().enumerate().skip(1) {
        let larger = value > largest;
        best = select_unpredictable(larger, action, best);
        largest = select_unpredictable(larger, value, largest);
    }
    (best, largest)
}
