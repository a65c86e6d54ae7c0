//! `Blackjack` with numbered states, as `qtab` numbers them: `(sum * 11 + card) * 2 + ace`.

use qtab_core::Env;
use qtab_core::envs::Step;
use qtab_core::envs::toy_text::{Blackjack, BlackjackState};
use qtab_core::random::Rng;

use super::Board;

const SUMS: usize = Blackjack::OBSERVATION_SHAPE[0];
const CARDS: usize = Blackjack::OBSERVATION_SHAPE[1];
const ACES: usize = Blackjack::OBSERVATION_SHAPE[2];
/// The sums that a player can have: rows of the map, from the top.
const SHOWN_SUMS: [usize; 2] = [21, 4];
/// The sum below which a hand has no usable ace.
const LOWEST_WITH_ACE: usize = 12;

/// `Blackjack` whose observations are the numbers of its states.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NumberedBlackjack(Blackjack);

impl NumberedBlackjack {
    /// The rules that Gymnasium registers as `Blackjack-v1`.
    pub(crate) const V1: Self = Self(Blackjack { natural: false, sab: true });

    pub(crate) const NUM_STATES: u32 = (SUMS * CARDS * ACES) as u32;

    /// The states without a usable ace on the left and with one on the right: a row for each sum, a column for each card
    /// of the dealer.
    pub(crate) fn board() -> Board {
        let [most, least] = SHOWN_SUMS;
        let cards = 1..CARDS;
        let cell = |sum: usize, card: usize, ace: usize| {
            let is_possible = ace == 0 || sum >= LOWEST_WITH_ACE;
            is_possible.then_some(((sum * CARDS + card) * ACES + ace) as u32)
        };
        let row = |sum| {
            let half = |ace| cards.clone().map(move |card| cell(sum, card, ace));
            half(0).chain([None]).chain(half(1)).collect::<Vec<_>>()
        };
        let states: Vec<Option<u32>> = (least..=most).rev().flat_map(row).collect();
        Board::new(2 * cards.len() + 1, states, Self::NUM_STATES as usize)
    }
}

impl Env for NumberedBlackjack {
    type State = BlackjackState;
    type Action = usize;
    type Observation = u32;

    fn num_actions(&self) -> usize {
        self.0.num_actions()
    }

    #[inline]
    fn reset(&self, rng: &mut impl Rng) -> BlackjackState {
        self.0.reset(rng)
    }

    #[inline]
    fn step(&self, state: BlackjackState, action: usize, rng: &mut impl Rng) -> Step<BlackjackState> {
        self.0.step(state, action, rng)
    }

    #[inline]
    fn observe(&self, state: &BlackjackState) -> u32 {
        let [sum, card, ace] = self.0.observe(state);
        (sum * CARDS as u32 + card) * ACES as u32 + ace
    }
}
