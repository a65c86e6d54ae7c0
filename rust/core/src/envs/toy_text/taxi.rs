//! `Taxi`: fetch the passenger, bring them where they want (T. Dietterich, 2000, section 3.1; the fickle one: 7.1).

use crate::envs::tabular::TabularMdp;
use crate::envs::{Env, Step, TransitionProbability};
use crate::random::Rng;

/// A state is ((row * 5 + column) * 5 + passenger) * 4 + destination.
const DESTINATIONS: u32 = 4;
const PLACES: u32 = 5;
/// The passenger's place once they are in the taxi.
const ABOARD: u32 = 4;

/// Gymnasium's table, dry or rainy, and what the table does not say.
#[derive(Clone, Debug, PartialEq)]
pub struct Taxi {
    /// `P`.
    pub table: TabularMdp,
    /// How likely it is that an episode's passenger changes their mind; None where passengers do not.
    pub fickle: Option<f64>,
}

/// The table's state, and what is to come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TaxiState {
    /// The state in the table.
    pub cell: u32,
    /// Whether the passenger wants to go elsewhere once the taxi has moved with them.
    pub fickle: bool,
}

impl Taxi {
    /// Whether a step took the passenger along to another square.
    #[inline]
    pub fn carries(before: u32, after: u32) -> bool {
        let square = DESTINATIONS * PLACES;
        before / DESTINATIONS % PLACES == ABOARD && after / square != before / square
    }

    /// The same state with the three other destinations.
    #[inline]
    pub fn elsewhere(cell: u32) -> [u32; 3] {
        let old = cell % DESTINATIONS;
        [0, 1, 2].map(|other| cell - old + other + u32::from(other >= old))
    }
}

impl Env for Taxi {
    type State = TaxiState;
    type Action = usize;
    type Observation = u32;

    #[inline]
    fn num_actions(&self) -> usize {
        self.table.num_actions()
    }

    #[inline]
    fn reset(&self, rng: &mut impl Rng) -> TaxiState {
        let cell = self.table.reset(rng);
        TaxiState { cell, fickle: self.fickle.is_some_and(|probability| rng.random() < probability) }
    }

    #[inline]
    fn step(&self, state: TaxiState, action: usize, rng: &mut impl Rng) -> Step<TaxiState> {
        self.step_with_probability(state, action, rng).0
    }

    #[inline]
    fn observe(&self, state: &TaxiState) -> u32 {
        state.cell
    }
}

impl TransitionProbability for Taxi {
    #[inline]
    fn step_with_probability(&self, state: TaxiState, action: usize, rng: &mut impl Rng) -> (Step<TaxiState>, f64) {
        let (Step { state: mut cell, reward, terminated }, probability) =
            self.table.step_with_probability(state.cell, action, rng);
        let mut fickle = state.fickle;
        if fickle && Self::carries(state.cell, cell) {
            fickle = false;
            // One of the three others, `np_random.choice` of them.
            cell = Self::elsewhere(cell)[rng.integers(DESTINATIONS - 1) as usize];
        }
        (Step { state: TaxiState { cell, fickle }, reward, terminated }, probability)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envs::tabular::Outcome;
    use crate::random::{Pcg64, SeedSequence};

    /// A taxi whose action 0 stays and whose action 1 goes a square on, round and round.
    fn taxi(fickle: Option<f64>) -> Taxi {
        let to = |state: i64| vec![Outcome { probability: 1.0, state, reward: -1.0, terminated: false }];
        let rows: Vec<_> = (0..500).flat_map(|state| [to(state), to((state + 20) % 500)]).collect();
        let table = TabularMdp::new(2, &[1.0 / 500.0; 500], &rows).expect("a table");
        Taxi { table, fickle }
    }

    fn stream() -> Pcg64 {
        Pcg64::new(&SeedSequence::new(&[0]))
    }

    #[test]
    fn a_steady_passenger_draws_nothing_more() {
        let mut rng = stream();
        assert!(!taxi(None).reset(&mut rng).fickle);
        assert_eq!(rng.words_drawn(), 1);
        assert!(taxi(Some(1.0)).reset(&mut rng).fickle);
        assert_eq!(rng.words_drawn(), 3);
    }

    #[test]
    fn a_fickle_passenger_changes_their_mind_once_on_the_way() {
        let taxi = taxi(Some(1.0));
        for wish in 0..4 {
            let mut rng = stream();
            let aboard = TaxiState { cell: 16 + wish, fickle: true };
            let stays = taxi.step(aboard, 0, &mut rng).state;
            assert_eq!(stays, aboard);
            let moved = taxi.step(stays, 1, &mut rng).state;
            assert_eq!(moved.cell / 4, (16 + 20) / 4);
            assert_ne!(moved.cell % 4, wish);
            assert!(!moved.fickle);
            assert_eq!(taxi.step(moved, 1, &mut rng).state.cell, moved.cell + 20);
        }
    }

    #[test]
    fn who_waits_at_the_kerb_keeps_their_wish() {
        let waiting = TaxiState { cell: 1, fickle: true };
        assert_eq!(taxi(Some(1.0)).step(waiting, 1, &mut stream()).state, TaxiState { cell: 21, fickle: true });
    }
}
