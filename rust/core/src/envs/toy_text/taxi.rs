//! `Taxi`: pick up a passenger and drop them off at their destination (T. Dietterich, 2000, section 3.1; the fickle
//! passenger is in section 7.1).

use crate::envs::tabular::TabularMdp;
use crate::envs::{Env, Step, TransitionProbability};
use crate::persist_struct;
use crate::random::Rng;

/// The index of a state is `((row * 5 + column) * 5 + passenger) * 4 + destination`.
const NUM_DESTINATIONS: u32 = 4;
const NUM_PASSENGER_LOCATIONS: u32 = 5;
/// The passenger location "in the taxi".
const IN_TAXI: u32 = 4;

/// Gymnasium's transition table, dry or rainy, with the fickle passenger that the table does not describe.
#[derive(Clone, Debug, PartialEq)]
pub struct Taxi {
    /// The transition table `P`.
    pub table: TabularMdp,
    /// The probability that the passenger of an episode is fickle; `None` if passengers never are.
    pub fickle: Option<f64>,
}

/// The state of the table, and whether the passenger is fickle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TaxiState {
    /// The index of the state in the table.
    pub cell: u32,
    /// Whether the passenger will change the destination when the taxi first moves with them.
    pub fickle: bool,
}

persist_struct!(TaxiState { cell, fickle });

impl Taxi {
    /// Whether a step from state `before` to state `after` moved the taxi while the passenger was in it.
    #[inline]
    pub fn moves_passenger(before: u32, after: u32) -> bool {
        let states_per_square = NUM_DESTINATIONS * NUM_PASSENGER_LOCATIONS;
        let in_taxi = before / NUM_DESTINATIONS % NUM_PASSENGER_LOCATIONS == IN_TAXI;
        in_taxi && after / states_per_square != before / states_per_square
    }

    /// The same state with each of the three other destinations.
    #[inline]
    pub fn with_other_destinations(cell: u32) -> [u32; 3] {
        let destination = cell % NUM_DESTINATIONS;
        [0, 1, 2].map(|other| cell - destination + other + u32::from(other >= destination))
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
        if fickle && Self::moves_passenger(state.cell, cell) {
            fickle = false;
            // `np_random.choice` of the three other destinations.
            cell = Self::with_other_destinations(cell)[rng.integers(NUM_DESTINATIONS - 1) as usize];
        }
        (Step { state: TaxiState { cell, fickle }, reward, terminated }, probability)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envs::tabular::Outcome;
    use crate::random::{Pcg64, SeedSequence};

    /// A taxi whose action 0 stays and whose action 1 moves to the next square, around in a circle.
    fn taxi(fickle: Option<f64>) -> Taxi {
        let to = |state: i64| vec![Outcome { probability: 1.0, state, reward: -1.0, terminated: false }];
        let rows: Vec<_> = (0..500).flat_map(|state| [to(state), to((state + 20) % 500)]).collect();
        let table = TabularMdp::new(2, &[1.0 / 500.0; 500], &rows).expect("a valid table");
        Taxi { table, fickle }
    }

    fn rng() -> Pcg64 {
        Pcg64::new(&SeedSequence::new(&[0]))
    }

    #[test]
    fn only_a_fickle_taxi_draws_a_second_number_at_reset() {
        let mut rng = rng();
        assert!(!taxi(None).reset(&mut rng).fickle);
        assert_eq!(rng.words_drawn(), 1);
        assert!(taxi(Some(1.0)).reset(&mut rng).fickle);
        assert_eq!(rng.words_drawn(), 3);
    }

    #[test]
    fn a_fickle_passenger_changes_the_destination_once() {
        let taxi = taxi(Some(1.0));
        for destination in 0..4 {
            let mut rng = rng();
            let in_taxi = TaxiState { cell: 16 + destination, fickle: true };
            let stays = taxi.step(in_taxi, 0, &mut rng).state;
            assert_eq!(stays, in_taxi);
            let moved = taxi.step(stays, 1, &mut rng).state;
            assert_eq!(moved.cell / 4, (16 + 20) / 4);
            assert_ne!(moved.cell % 4, destination);
            assert!(!moved.fickle);
            assert_eq!(taxi.step(moved, 1, &mut rng).state.cell, moved.cell + 20);
        }
    }

    #[test]
    fn a_waiting_passenger_keeps_the_destination() {
        let waiting = TaxiState { cell: 1, fickle: true };
        assert_eq!(taxi(Some(1.0)).step(waiting, 1, &mut rng()).state, TaxiState { cell: 21, fickle: true });
    }
}
