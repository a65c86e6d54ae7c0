//! `Blackjack-v1`: get nearer to 21 than the dealer, and not beyond (Sutton & Barto, 2nd ed., Example 5.1).

use super::hand::{Hand, TEN};
use crate::envs::{Env, Step};
use crate::random::Rng;

/// An endless deck: the ace, the numbers, and ten for each of the faces.
pub const DECK: [u32; 13] = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 10, 10, 10];
/// The dealer draws below this.
pub const DEALER_STICKS: u32 = 17;
/// Of the dealer's open card, for its picture.
const SUITS: u32 = 4;
const FACES: u32 = 3;
/// Stick or hit.
const ACTIONS: usize = 2;

/// The rules, under Gymnasium's names.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Blackjack {
    /// A win with an ace and a ten pays 1.5.
    pub natural: bool,
    /// The book's rules: an ace and a ten wins, unless the dealer has them too; `natural` is not looked at.
    pub sab: bool,
}

/// The table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BlackjackState {
    /// The player's hand.
    pub player: Hand,
    /// The dealer's.
    pub dealer: Hand,
    /// The dealer's open card.
    pub shown: u32,
}

impl Blackjack {
    /// How many numbers Gymnasium's observations take: of the sum, the open card, the usable ace.
    pub const OBSERVATION_SHAPE: [usize; 3] = [32, 11, 2];

    /// Each card of the deck, and how likely it is.
    pub fn cards() -> impl Iterator<Item = (f64, u32)> {
        DECK.iter().map(|&card| (1.0 / DECK.len() as f64, card))
    }

    /// What the dealer ends with who shows this card, and how likely it is. Hands of the same worth are one.
    pub fn dealers_hands(shown: u32) -> Vec<(f64, Hand)> {
        let mut hands: Vec<(f64, Hand)> = Vec::new();
        let mut open = vec![(1.0, Hand::default().with(shown))];
        while let Some((probability, hand)) = open.pop() {
            if hand.sum() < DEALER_STICKS {
                open.extend(Self::cards().map(|(share, card)| (probability * share, hand.with(card))));
                continue;
            }
            let same =
                |(_, other): &&mut (f64, Hand)| (other.score(), other.natural()) == (hand.score(), hand.natural());
            match hands.iter_mut().find(same) {
                Some((sum, _)) => *sum += probability,
                None => hands.push((probability, hand)),
            }
        }
        hands
    }

    /// What a player who sticks gets when the dealer has drawn.
    #[inline]
    pub fn payoff(&self, player: &Hand, dealer: &Hand) -> f64 {
        let (mine, theirs) = (player.score(), dealer.score());
        if self.sab && player.natural() && !dealer.natural() {
            1.0
        } else if mine > theirs {
            if !self.sab && self.natural && player.natural() { 1.5 } else { 1.0 }
        } else if mine < theirs {
            -1.0
        } else {
            0.0
        }
    }
}

/// `np_random.choice(deck)`.
#[inline]
fn card(rng: &mut impl Rng) -> u32 {
    DECK[rng.integers(DECK.len() as u32) as usize]
}

impl Env for Blackjack {
    type State = BlackjackState;
    type Action = usize;
    /// The player's sum, the dealer's open card, whether the player has a usable ace.
    type Observation = [u32; 3];

    #[inline]
    fn num_actions(&self) -> usize {
        ACTIONS
    }

    #[inline]
    fn reset(&self, rng: &mut impl Rng) -> BlackjackState {
        let shown = card(rng);
        let dealer = Hand::default().with(shown).with(card(rng));
        let player = Hand::default().with(card(rng)).with(card(rng));
        // The picture of the open card is drawn from the same stream.
        rng.integers(SUITS);
        if shown == TEN {
            rng.integers(FACES);
        }
        BlackjackState { player, dealer, shown }
    }

    #[inline]
    fn step(&self, mut state: BlackjackState, action: usize, rng: &mut impl Rng) -> Step<BlackjackState> {
        assert!(action < ACTIONS, "action {action} is none of {ACTIONS}");
        if action == 1 {
            state.player = state.player.with(card(rng));
            let terminated = state.player.bust();
            return Step { state, reward: if terminated { -1.0 } else { 0.0 }, terminated };
        }
        while state.dealer.sum() < DEALER_STICKS {
            state.dealer = state.dealer.with(card(rng));
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
    fn a_natural_pays_by_the_rules() {
        let (natural, other, low) = (hand(&[1, 10]), hand(&[10, 5, 6]), hand(&[10, 7]));
        let book = Blackjack { natural: true, sab: true };
        let casino = Blackjack { natural: true, sab: false };
        let plain = Blackjack::default();
        assert_eq!([book, casino, plain].map(|rules| rules.payoff(&natural, &other)), [1.0, 0.0, 0.0]);
        assert_eq!([book, casino, plain].map(|rules| rules.payoff(&natural, &low)), [1.0, 1.5, 1.0]);
        assert_eq!([book, casino, plain].map(|rules| rules.payoff(&natural, &natural)), [0.0, 0.0, 0.0]);
        assert_eq!([book, casino, plain].map(|rules| rules.payoff(&low, &natural)), [-1.0, -1.0, -1.0]);
        assert_eq!(plain.payoff(&low, &hand(&[10, 6, 10])), 1.0);
    }

    #[test]
    fn the_first_hands_of_seed_zero_are_gymnasiums() {
        // env.reset(seed=0): the dealer has 10 and 9, the player 7 and 4; the open card is the jack of diamonds
        let mut rng = Pcg64::new(&SeedSequence::new(&[0]));
        let game = Blackjack::default();
        let state = game.reset(&mut rng);
        assert_eq!(state, BlackjackState { player: hand(&[7, 4]), dealer: hand(&[10, 9]), shown: 10 });
        assert_eq!(game.observe(&state), [11, 10, 0]);
        assert_eq!((rng.words_drawn(), rng.buffered_u32()), (3, None));
        assert_eq!(game.step(state, 0, &mut rng), Step { state, reward: -1.0, terminated: true });
    }

    #[test]
    fn who_busts_loses_at_once() {
        let mut rng = Pcg64::new(&SeedSequence::new(&[0]));
        let state = BlackjackState { player: hand(&[10, 10, 1]), ..BlackjackState::default() };
        let step = Blackjack::default().step(state, 1, &mut rng);
        assert_eq!((step.reward, step.terminated), (-1.0, true));
    }
}
