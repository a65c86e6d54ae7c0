//! `FrozenLake-v1` and its table.

use crate::envs::tabular::{InvalidMdp, Outcome, TabularMdp};
use crate::envs::{Env, Step};
use crate::random::Rng;

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

/// The rewards of Gymnasium: 1 for the goal, otherwise 0.
impl Default for LakeRewards {
    fn default() -> Self {
        Self { goal: 1.0, hole: 0.0, frozen: 0.0 }
    }
}

/// Gymnasium's `FrozenLake-v1`: the actions are left, down, right and up, and an observation is the number of the cell,
/// row by row. The default is the slippery map of 4 by 4 cells, whose usual time limit is 100 steps.
#[derive(Clone, Debug, PartialEq)]
pub struct FrozenLake {
    table: TabularMdp,
}

impl FrozenLake {
    /// Gymnasium's map of 4 by 4 cells.
    pub const MAP_4X4: [&'static str; 4] = ["SFFF", "FHFH", "FFFH", "HFFG"];
    /// Gymnasium's map of 8 by 8 cells, whose usual time limit is 200 steps.
    pub const MAP_8X8: [&'static str; 8] =
        ["SFFFFFFF", "FFFFFFFF", "FFFHFFFF", "FFFFFHFF", "FFFHFFFF", "FHHFFFHF", "FHFFHFHF", "FFFHFFFG"];
    /// Gymnasium's probability of moving in the direction of the action on slippery ice.
    pub const SUCCESS_RATE: f64 = 1.0 / 3.0;

    /// A lake with this map and these options, as for [`frozen_lake`].
    ///
    /// # Errors
    /// As for [`frozen_lake`].
    pub fn new<L: AsRef<[u8]>>(
        lines: &[L],
        success_rate: Option<f64>,
        rewards: LakeRewards,
    ) -> Result<Self, InvalidMdp> {
        let lines: Vec<Vec<u8>> = lines.iter().map(|line| line.as_ref().to_vec()).collect();
        Ok(Self { table: frozen_lake(&lines, success_rate, rewards)? })
    }

    /// The transition table, for [planning](crate::planning).
    pub fn table(&self) -> &TabularMdp {
        &self.table
    }

    /// The number of cells.
    pub fn num_states(&self) -> usize {
        self.table.num_states()
    }
}

impl Default for FrozenLake {
    fn default() -> Self {
        match Self::new(&Self::MAP_4X4, Some(Self::SUCCESS_RATE), LakeRewards::default()) {
            Ok(lake) => lake,
            Err(_) => unreachable!("the map is valid"),
        }
    }
}

impl Env for FrozenLake {
    type State = u32;
    type Action = usize;
    type Observation = u32;

    #[inline]
    fn num_actions(&self) -> usize {
        self.table.num_actions()
    }

    #[inline]
    fn reset(&self, rng: &mut impl Rng) -> u32 {
        self.table.reset(rng)
    }

    #[inline]
    fn step(&self, state: u32, action: usize, rng: &mut impl Rng) -> Step<u32> {
        self.table.step(state, action, rng)
    }

    #[inline]
    fn observe(&self, &state: &u32) -> u32 {
        state
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Pcg64, SeedSequence};

    #[test]
    fn the_environment_steps_as_its_table() {
        let lines = FrozenLake::MAP_4X4.map(|line| line.as_bytes().to_vec());
        let table = frozen_lake(&lines, Some(1.0 / 3.0), LakeRewards::default()).expect("a valid map");
        let lake = FrozenLake::default();
        assert_eq!((lake.table(), lake.num_states(), lake.num_actions()), (&table, 16, 4));
        let (mut rng, mut other) = (Pcg64::new(&SeedSequence::from(0)), Pcg64::new(&SeedSequence::from(0)));
        let (mut state, mut of_table) = (lake.reset(&mut rng), table.reset(&mut other));
        for action in [2, 2, 1, 1, 1, 2] {
            let step = lake.step(state, action, &mut rng);
            assert_eq!(step, table.step(of_table, action, &mut other));
            (state, of_table) = (step.state, step.state);
        }
        assert_eq!(lake.observe(&state), state);
    }

    #[test]
    fn a_map_that_is_not_a_rectangle_is_refused() {
        let error = FrozenLake::new(&["SF", "G"], None, LakeRewards::default()).expect_err("lines of two lengths");
        assert_eq!(error.to_string(), "the lines of the map must have the same length");
    }
}
