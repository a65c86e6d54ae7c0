//! `Blackjack-v1`: get closer to 21 than the dealer without exceeding it (Sutton & Barto, Example 5.1).

use super::hand::{Hand, TEN};
use crate::envs::{Env, Step};
use crate::persist_struct;
use crate::random::Rng;

/// The values of an infinite deck: the ace, 2 to 10, and 10 for each of the face cards.
pub const DECK: [u32; 13] = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 10, 10, 10];
/// The dealer hits below this sum.
pub const DEALER_STICKS: u32 = 17;
/// The numbers of suits and of face cards, from which the picture of the dealer's card is drawn.
const SUITS: u32 = 4;
const FACES: u32 = 3;
/// The number of actions: stick or hit.
const NUM_ACTIONS: usize = 2;

/// The rules, with Gymnasium's names.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Blackjack {
    /// Whether a win with a natural (an ace and a ten) pays 1.5.
    pub natural: bool,
    /// Whether the rules of Sutton & Barto apply: a natural wins 1 unless the dealer has one too. `natural` is then
    /// ignored.
    pub sab: bool,
}

/// The hands of both sides.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BlackjackState {
    /// The player's hand.
    pub player: Hand,
    /// The dealer's hand.
    pub dealer: Hand,
    /// The dealer's face-up card.
    pub shown: u32,
}

persist_struct!(BlackjackState { player, dealer, shown });

impl Blackjack {
    /// The sizes of Gymnasium's observation space: the player's sum, the dealer's card, the usable ace.
    pub const OBSERVATION_SHAPE: [usize; 3] = [32, 11, 2];

    /// The cards of the deck with their probabilities.
    pub fn cards() -> impl Iterator<Item = (f64, u32)> {
        DECK.iter().map(|&card| (1.0 / DECK.len() as f64, card))
    }

    /// The final hands of a dealer who shows this card, with their probabilities. Hands that pay the same are merged.
    pub fn dealer_hands(shown: u32) -> Vec<(f64, Hand)> {
        let mut hands: Vec<(f64, Hand)> = Vec::new();
        let mut unfinished = vec![(1.0, Hand::default().with(shown))];
        while let Some((probability, hand)) = unfinished.pop() {
            if hand.sum() < DEALER_STICKS {
                unfinished.extend(Self::cards().map(|(chance, card)| (probability * chance, hand.with(card))));
                continue;
            }
            let pays_the_same = |(_, other): &&mut (f64, Hand)| {
                (other.score(), other.is_natural()) == (hand.score(), hand.is_natural())
            };
            match hands.iter_mut().find(pays_the_same) {
                Some((sum, _)) => *sum += probability,
                None => hands.push((probability, hand)),
            }
        }
        hands
    }

    /// The player's reward for sticking, given the dealer's final hand.
    #[inline]
    pub fn payoff(&self, player: &Hand, dealer: &Hand) -> f64 {
        let (player_score, dealer_score) = (player.score(), dealer.score());
        if self.sab && player.is_natural() && !dealer.is_natural() {
            1.0
        } else if player_score > dealer_score {
            if !self.sab && self.natural && player.is_natural() { 1.5 } else { 1.0 }
        } else if player_score < dealer_score {
            -1.0
        } else {
            0.0
        }
    }
}

/// Draws a card: `np_random.choice(deck)`.
#[inline]
fn draw_card(rng: &mut impl Rng) -> u32 {
    DECK[rng.integers(DECK.len() as u32) as usize]
}

impl Env for Blackjack {
    type State = BlackjackState;
    type Action = usize;
    /// The player's sum, the dealer's face-up card, and whether the player has a usable ace.
    type Observation = [u32; 3];

    #[inline]
    fn num_actions(&self) -> usize {
        NUM_ACTIONS
    }

    #[inline]
    fn reset(&self, rng: &mut impl Rng) -> BlackjackState {
        let shown = draw_card(rng);
        let dealer = Hand::default().with(shown).with(draw_card(rng));
        let player = Hand::default().with(draw_card(rng)).with(draw_card(rng));
        // Gymnasium draws the picture of the dealer's card from the same generator.
        rng.integers(SUITS);
        if shown == TEN {
            rng.integers(FACES);
        }
        BlackjackState { player, dealer, shown }
    }

    #[inline]
    fn step(&self, mut state: BlackjackState, action: usize, rng: &mut impl Rng) -> Step<BlackjackState> {
        assert!(action < NUM_ACTIONS, "action must be less than {NUM_ACTIONS}, got {action}");
        if action == 1 {
            state.player = state.player.with(draw_card(rng));
            let terminated = state.player.is_bust();
            return Step { state, reward: if terminated { -1.0 } else { 0.0 }, terminated };
        }
        while state.dealer.sum() < DEALER_STICKS {
            state.dealer = state.dealer.with(draw_card(rng));
        }
        Step { state, reward: self.payoff(&state.player, &state.dealer), terminated: true }
    }

    #[inline]
    fn observe(&self, state: &BlackjackState) -> [u32; 3] {
        [state.player.sum(), state.shown, u32::from(state.player.usable_ace())]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::{Pcg64, SeedSequence};

    fn hand(cards: &[u32]) -> Hand {
        cards.iter().fold(Hand::default(), |hand, &card| hand.with(card))
    }

    #[test]
    fn a_natural_pays_as_the_rules_say() {
        let (natural, other, low) = (hand(&[1, 10]), hand(&[10, 5, 6]), hand(&[10, 7]));
        let book = Blackjack { natural: true, sab: true };
        let natural_pays_more = Blackjack { natural: true, sab: false };
        let default = Blackjack::default();
        assert_eq!([book, natural_pays_more, default].map(|rules| rules.payoff(&natural, &other)), [1.0, 0.0, 0.0]);
        assert_eq!([book, natural_pays_more, default].map(|rules| rules.payoff(&natural, &low)), [1.0, 1.5, 1.0]);
        assert_eq!([book, natural_pays_more, default].map(|rules| rules.payoff(&natural, &natural)), [0.0, 0.0, 0.0]);
        assert_eq!([book, natural_pays_more, default].map(|rules| rules.payoff(&low, &natural)), [-1.0, -1.0, -1.0]);
        assert_eq!(default.payoff(&low, &hand(&[10, 6, 10])), 1.0);
    }

    #[test]
    fn the_first_hands_of_seed_0_match_gymnasium() {
        // env.reset(seed=0): the dealer has 10 and 9, the player 7 and 4. The face-up card is the jack of diamonds.
        let mut rng = Pcg64::new(&SeedSequence::new(&[0]));
        let game = Blackjack::default();
        let state = game.reset(&mut rng);
        assert_eq!(state, BlackjackState { player: hand(&[7, 4]), dealer: hand(&[10, 9]), shown: 10 });
        assert_eq!(game.observe(&state), [11, 10, 0]);
        assert_eq!((rng.words_drawn(), rng.buffered_u32()), (3, None));
        assert_eq!(game.step(state, 0, &mut rng), Step { state, reward: -1.0, terminated: true });
    }

    #[test]
    fn a_bust_loses_immediately() {
        let mut rng = Pcg64::new(&SeedSequence::new(&[0]));
        let state = BlackjackState { player: hand(&[10, 10, 1]), ..BlackjackState::default() };
        let step = Blackjack::default().step(state, 1, &mut rng);
        assert_eq!((step.reward, step.terminated), (-1.0, true));
    }
}
