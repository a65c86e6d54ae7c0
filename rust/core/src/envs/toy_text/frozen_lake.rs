//! The table of `FrozenLake-v1`.

use crate::envs::tabular::{InvalidMdp, Outcome, TabularMdp};

/// The rows and the columns that an action moves by: left, down, right, up.
const MOVES: [(isize, isize); 4] = [(0, -1), (1, 0), (0, 1), (-1, 0)];

/// The reward of a step, by the kind of cell it leads to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LakeRewards {
    /// The reward for reaching the goal.
    pub goal: f64,
    /// The reward for falling into a hole.
    pub hole: f64,
    /// The reward for a step onto frozen ground, including the start.
    pub frozen: f64,
}

/// The table as Gymnasium's constructor builds it. In the lines of the map, `S` marks an initial state, `G` the goal
/// and `H` a hole; everything else is frozen. With a `success_rate` the ice is slippery: an action moves in its own
/// direction with this probability, and in each of the two perpendicular directions with half of the remaining
/// probability.
///
/// # Errors
/// If the lines have different lengths; and those of [`TabularMdp::new`], for a map without a start or a rate outside
/// [0, 1].
pub fn frozen_lake(
    lines: &[Vec<u8>],
    success_rate: Option<f64>,
    rewards: LakeRewards,
) -> Result<TabularMdp, InvalidMdp> {
    let columns = lines.first().map_or(0, Vec::len);
    if lines.iter().any(|line| line.len() != columns) {
        return Err(InvalidMdp("the lines of the map must have the same length".into()));
    }
    let letters = lines.concat();
    let mut initial: Vec<f64> = letters.iter().map(|&letter| f64::from(u8::from(letter == b'S'))).collect();
    let starts: f64 = initial.iter().sum();
    for probability in &mut initial {
        *probability /= starts;
    }
    let step = |state: usize, direction: usize, probability: f64| {
        let moved = |position: usize, by: isize, count: usize| position.saturating_add_signed(by).min(count - 1);
        let (down, right) = MOVES[direction];
        let next = moved(state / columns, down, lines.len()) * columns + moved(state % columns, right, columns);
        let (reward, terminated) = match letters[next] {
            b'G' => (rewards.goal, true),
            b'H' => (rewards.hole, true),
            _ => (rewards.frozen, false),
        };
        Outcome { probability, state: next.cast_signed() as i64, reward, terminated }
    };
    let outcomes = |state: usize, action: usize| match (letters[state], success_rate) {
        (b'G' | b'H', _) => {
            vec![Outcome { probability: 1.0, state: state.cast_signed() as i64, reward: 0.0, terminated: true }]
        }
        (_, None) => vec![step(state, action, 1.0)],
        (_, Some(success_rate)) => {
            let fail_rate = (1.0 - success_rate) / 2.0;
            let turns = [(3, fail_rate), (0, success_rate), (1, fail_rate)];
            turns.map(|(turn, probability)| step(state, (action + turn) % MOVES.len(), probability)).to_vec()
        }
    };
    let pairs: Vec<_> = (0..letters.len())
        .flat_map(|state| (0..MOVES.len()).map(move |action| (state, action)))
        .map(|(state, action)| outcomes(state, action))
        .collect();
    TabularMdp::new(MOVES.len(), &initial, &pairs)
}
