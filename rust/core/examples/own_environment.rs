//! An environment of one's own, trained with two algorithms and evaluated: `cargo run --release --example
//! own_environment`.

#![expect(clippy::print_stdout, reason = "a program that shows its results")]

use std::error::Error;

use qtab_core::envs::{Env, Step};
use qtab_core::features::MultiDiscreteIndex;
use qtab_core::learners::AnyAlgorithm;
use qtab_core::random::Rng;
use qtab_core::settings::ScheduleSpec;
use qtab_core::{Features, Trainer};

const WIDTH: u32 = 10;
const HEIGHT: u32 = 7;
const GOAL: Cell = Cell { x: 7, y: 3 };
/// The cells that the wind moves the walker up by, in each column.
const WIND: [u32; WIDTH as usize] = [0, 0, 0, 1, 1, 1, 2, 2, 1, 0];
const EPISODES: usize = 3000;

/// The windy gridworld (Sutton & Barto, Example 6.5), with a chance that the wind is calm.
struct WindyGrid {
    calm: f64,
}

#[derive(Clone, Copy, PartialEq)]
struct Cell {
    x: u32,
    y: u32,
}

qtab_core::persist_struct!(Cell { x, y });

impl Env for WindyGrid {
    type State = Cell;
    type Action = usize;
    type Observation = [u32; 2];

    fn num_actions(&self) -> usize {
        4
    }

    fn reset(&self, _rng: &mut impl Rng) -> Cell {
        Cell { x: 0, y: 3 }
    }

    fn step(&self, state: Cell, action: usize, rng: &mut impl Rng) -> Step<Cell> {
        let Cell { x, y } = state;
        let wind = if rng.random() < self.calm { 0 } else { WIND[x as usize] };
        // Left, down, right, up.
        let (x, y) = match action {
            0 => (x.saturating_sub(1), y),
            1 => (x, y + 1),
            2 => (x + 1, y),
            _ => (x, y.saturating_sub(1)),
        };
        let state = Cell { x: x.min(WIDTH - 1), y: y.min(HEIGHT - 1).saturating_sub(wind) };
        Step { state, reward: -1.0, terminated: state == GOAL }
    }

    fn observe(&self, state: &Cell) -> [u32; 2] {
        [state.y, state.x]
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let cells = MultiDiscreteIndex([HEIGHT, WIDTH]);
    for algorithm in [AnyAlgorithm::QLearning, AnyAlgorithm::Sarsa] {
        let mut trainer = Trainer::builder(WindyGrid { calm: 0.1 }, cells)
            .algorithm(algorithm)
            .max_episode_steps(500)
            .episodes(EPISODES as u64)
            .epsilon(ScheduleSpec::linear(0.5, 0.01))
            .learning_rate(0.3)
            .discount(1.0)
            .build()?;
        trainer.train(EPISODES)?;
        let evaluation = trainer.evaluate(200, 1)?;
        println!("{algorithm:?}: mean return {:.2}", evaluation.mean_return(200));
        if evaluation.mean_return(200) < -40.0 {
            return Err(format!("{algorithm:?} has not learned to reach the goal").into());
        }
        let policy = trainer.greedy_policy();
        for y in 0..HEIGHT {
            for x in 0..WIDTH {
                let arrow = ["←", "↓", "→", "↑"][policy.action(cells.active_rows(&[y, x])?)];
                print!("{} ", if (Cell { x, y }) == GOAL { "G" } else { arrow });
            }
            println!();
        }
    }
    Ok(())
}

#[test]
fn both_algorithms_learn() {
    main().expect("the example runs");
}
