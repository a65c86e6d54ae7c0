//! The loop over the lanes of a batch.

use std::hint::select_unpredictable;

use super::Article;
use super::words::Words;
use crate::envs::MountainCarState;
use crate::envs::mountain_car::{DIRECTIONS, REWARD, drive_all};
use crate::features::Outside;
use crate::hint::seldom;
use crate::learners::{Agent, TerminalUpdate};
use crate::trainer::{Underway, Until};
use crate::worlds::Position;

const ACTIONS: usize = DIRECTIONS.len();

/// Runs that are alike and never leave their grid, and how far to go; compiled for each instruction set.
pub(super) struct Turns<'a, const K: usize> {
    pub(super) runs: &'a mut [Article; K],
    pub(super) until: Until,
}

impl<const K: usize> pulp::NullaryFnOnce for Turns<'_, K> {
    type Output = Result<(), (usize, Outside)>;

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
fn turns<const K: usize>(
    runs: &mut [Article; K],
    words: &mut [Words; K],
    until: Until,
) -> Result<(), (usize, Outside)> {
    let mut lanes = Lanes::<K>::begin(runs, words)?;
    let car = runs[0].world.env;
    let grid = runs[0].world.features.clone();
    let limit = runs[0].world.max_episode_steps;
    let Agent { learning_rate, discount, terminal_update, .. } = runs[0].learner.agent;
    let mut result = Ok(());
    let mut on = true;
    let mut steps = until.steps;
    while on && steps > 0 {
        steps -= 1;
        drive_all(&car, &mut lanes.position, &mut lanes.velocity, &lanes.action);
        let mut places = [0; K];
        let mut terminal = [false; K];
        let mut over = [false; K];
        let mut any = false;
        for lane in 0..K {
            let (position, velocity) = (lanes.position[lane], lanes.velocity[lane]);
            places[lane] = grid.row_inside([position as f32, velocity as f32]) as usize * ACTIONS;
            terminal[lane] = (position >= car.goal_position) & (velocity >= car.goal_velocity);
            lanes.elapsed[lane] += 1;
            lanes.total[lane] += REWARD;
            over[lane] = terminal[lane] | (lanes.elapsed[lane] >= limit);
            any |= over[lane];
        }
        for lane in 0..K {
            let values = runs[lane].learner.agent.table.values_mut();
            let (here, there) = (lanes.place[lane] + lanes.action[lane], places[lane]);
            let value = values[here];
            if terminal[lane] {
                seldom();
                values[here] = match terminal_update {
                    TerminalUpdate::Assign => REWARD,
                    TerminalUpdate::Target => value + learning_rate * (REWARD - value),
                };
                continue;
            }
            let (_, largest) = best(values, there);
            values[here] = value + learning_rate * ((REWARD + discount * largest) - value);
            if over[lane] {
                seldom();
                continue;
            }
            let (greedy, _) = best(values, there);
            let (explores, any) = words[lane].explore(lanes.greedy[lane], ACTIONS as u32);
            lanes.action[lane] = select_unpredictable(explores, any as usize, greedy);
            lanes.place[lane] = there;
        }
        if any {
            for lane in (0..K).filter(|&lane| over[lane]) {
                let run = &mut runs[lane];
                run.finish(lanes.total[lane], lanes.elapsed[lane].cast_signed(), terminal[lane]);
                lanes.underway[lane] = false;
                if run.episodes.returns.len() >= until.episodes {
                    on = false;
                    continue;
                }
                match run.begin(&mut words[lane]) {
                    Ok(now) => lanes.put(lane, now, run),
                    Err(outside) => {
                        result = Err((lane, outside));
                        on = false;
                    }
                }
            }
        }
    }
    for (lane, run) in runs.iter_mut().enumerate() {
        run.underway = lanes.get(lane);
    }
    result
}

/// Where the episodes of the lanes stand, field by field, as wide registers want it.
struct Lanes<const K: usize> {
    underway: [bool; K],
    position: [f64; K],
    velocity: [f64; K],
    elapsed: [u64; K],
    /// Where the current row begins in its table.
    place: [usize; K],
    action: [usize; K],
    total: [f64; K],
    /// A draw below this is greedy.
    greedy: [f64; K],
}

type Now = Underway<Position<MountainCarState>, [u32; 1]>;

impl<const K: usize> Lanes<K> {
    /// Goes on with each run's episode, or begins one.
    fn begin(runs: &mut [Article; K], words: &mut [Words; K]) -> Result<Self, (usize, Outside)> {
        for (lane, (run, words)) in runs.iter_mut().zip(words).enumerate() {
            if run.underway.is_none() {
                run.underway = Some(run.begin(words).map_err(|outside| (lane, outside))?);
            }
        }
        let mut lanes = Self {
            underway: [false; K],
            position: [0.0; K],
            velocity: [0.0; K],
            elapsed: [0; K],
            place: [0; K],
            action: [0; K],
            total: [0.0; K],
            greedy: [0.0; K],
        };
        for (lane, run) in runs.iter_mut().enumerate() {
            if let Some(now) = run.underway.take() {
                lanes.put(lane, now, run);
            }
        }
        Ok(lanes)
    }

    fn put(&mut self, lane: usize, now: Now, run: &Article) {
        self.underway[lane] = true;
        self.position[lane] = now.state.state.position;
        self.velocity[lane] = now.state.state.velocity;
        self.elapsed[lane] = now.state.elapsed;
        self.place[lane] = now.here[0] as usize * ACTIONS;
        self.action[lane] = now.action;
        self.total[lane] = now.total;
        self.greedy[lane] = 1.0 - run.learner.agent.policy.epsilon();
    }

    fn get(&self, lane: usize) -> Option<Now> {
        let state = MountainCarState { position: self.position[lane], velocity: self.velocity[lane] };
        self.underway[lane].then_some(Underway {
            state: Position { state, elapsed: self.elapsed[lane] },
            here: [(self.place[lane] / ACTIONS) as u32],
            action: self.action[lane],
            total: self.total[lane],
            length: self.elapsed[lane].cast_signed(),
        })
    }
}

/// The first of the largest values of a row, and that value, without a branch.
#[inline(always)]
fn best(values: &[f64], place: usize) -> (usize, f64) {
    let row = &values[place..][..ACTIONS];
    let (mut best, mut largest) = (0, row[0]);
    for (action, &value) in row.iter().enumerate().skip(1) {
        let larger = value > largest;
        best = select_unpredictable(larger, action, best);
        largest = select_unpredictable(larger, value, largest);
    }
    (best, largest)
}
