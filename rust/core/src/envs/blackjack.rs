//! `Blackjack-v1`: get nearer to 21 than the dealer, and not beyond (Sutton & Barto, 2nd ed., Example 5.1).

mod dealt;

pub use dealt::{Dealing, Dealt};

use crate::env::{Env, Step};
use crate::random::Draw;

/// An endless deck: the ace, the numbers, and ten for each of the faces.
pub const DECK: [u32; 13] = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 10, 10, 10];
const ACE: u32 = 1;
const TEN: u32 = 10;
const MOST: u32 = 21;
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

/// The cards of one side, as far as they matter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Hand {
    /// The sum, aces counting 1.
    pub total: u32,
    /// How many cards.
    pub cards: u32,
    /// Whether there is an ace.
    pub ace: bool,
}

impl Hand {
    /// The hand with one more card.
    #[inline]
    #[must_use]
    pub fn with(self, card: u32) -> Self {
        Self { total: self.total + card, cards: self.cards + 1, ace: self.ace || card == ACE }
    }

    /// A hand of three cards or more that shows this sum, with a usable ace or without; None where none does. Which
    /// cards they are makes no difference.
    pub fn showing(sum: u32, usable_ace: bool) -> Option<Self> {
        let total = sum.checked_sub(if usable_ace { 10 } else { 0 })?;
        let hand = Self { total, cards: 3, ace: usable_ace };
        (hand.sum() == sum && hand.usable_ace() == usable_ace && total > 0).then_some(hand)
    }

    /// Whether an ace can count 11.
    #[inline]
    pub fn usable_ace(&self) -> bool {
        self.ace && self.total + 10 <= MOST
    }

    /// The sum, an ace counting 11 where it can.
    #[inline]
    pub fn sum(&self) -> u32 {
        if self.usable_ace() { self.total + 10 } else { self.total }
    }

    /// Whether it is beyond 21.
    #[inline]
    pub fn bust(&self) -> bool {
        self.sum() > MOST
    }

    /// What counts in the end: nothing if it is bust.
    #[inline]
    pub fn score(&self) -> u32 {
        if self.bust() { 0 } else { self.sum() }
    }

    /// Whether it is an ace and a ten, no more.
    #[inline]
    pub fn natural(&self) -> bool {
        self.cards == 2 && self.ace && self.total == ACE + TEN
    }
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
    pub const CELLS: [usize; 3] = [32, 11, 2];

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
    pub fn settle(&self, player: &Hand, dealer: &Hand) -> f64 {
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
fn card(draw: &mut impl Draw) -> u32 {
    DECK[draw.integers(DECK.len() as u32) as usize]
}

impl Env for Blackjack {
    type State = BlackjackState;
    type Action = usize;
    /// The player's sum, the dealer's open card, whether the player has a usable ace.
    type Observation = [u32; 3];

    #[inline]
    fn actions(&self) -> usize {
        ACTIONS
    }

    #[inline]
    fn reset(&self, draw: &mut impl Draw) -> BlackjackState {
        let shown = card(draw);
        let dealer = Hand::default().with(shown).with(card(draw));
        let player = Hand::default().with(card(draw)).with(card(draw));
        // The picture of the open card is drawn from the same stream.
        draw.integers(SUITS);
        if shown == TEN {
            draw.integers(FACES);
        }
        BlackjackState { player, dealer, shown }
    }

    #[inline]
    fn step(&self, mut state: BlackjackState, action: usize, draw: &mut impl Draw) -> Step<BlackjackState> {
        assert!(action < ACTIONS, "action {action} is none of {ACTIONS}");
        if action == 1 {
            state.player = state.player.with(card(draw));
            let terminated = state.player.bust();
            return Step { state, reward: if terminated { -1.0 } else { 0.0 }, terminated };
        }
        while state.dealer.sum() < DEALER_STICKS {
            state.dealer = state.dealer.with(card(draw));
        }
        Step { state, reward: self.settle(&state.player, &state.dealer), terminated: true }
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
    fn an_ace_counts_eleven_until_it_would_bust() {
        assert_eq!(hand(&[1, 7]).sum(), 18);
        assert_eq!(hand(&[1, 1]).sum(), 12);
        assert_eq!(hand(&[1, 7, 10]).sum(), 18);
        assert!(!hand(&[1, 7, 10]).usable_ace());
        assert!(hand(&[10, 10, 2]).bust());
        assert_eq!(hand(&[10, 10, 2]).score(), 0);
    }

    #[test]
    fn only_an_ace_and_a_ten_are_a_natural() {
        assert!(hand(&[10, 1]).natural());
        assert!(!hand(&[1, 4, 6]).natural());
        assert!(!hand(&[5, 6]).natural());
    }

    #[test]
    fn a_natural_pays_by_the_rules() {
        let (natural, other, low) = (hand(&[1, 10]), hand(&[10, 5, 6]), hand(&[10, 7]));
        let book = Blackjack { natural: true, sab: true };
        let casino = Blackjack { natural: true, sab: false };
        let plain = Blackjack::default();
        assert_eq!([book, casino, plain].map(|rules| rules.settle(&natural, &other)), [1.0, 0.0, 0.0]);
        assert_eq!([book, casino, plain].map(|rules| rules.settle(&natural, &low)), [1.0, 1.5, 1.0]);
        assert_eq!([book, casino, plain].map(|rules| rules.settle(&natural, &natural)), [0.0, 0.0, 0.0]);
        assert_eq!([book, casino, plain].map(|rules| rules.settle(&low, &natural)), [-1.0, -1.0, -1.0]);
        assert_eq!(plain.settle(&low, &hand(&[10, 6, 10])), 1.0);
    }

    #[test]
    fn the_first_hands_of_seed_zero_are_gymnasiums() {
        // env.reset(seed=0): the dealer has 10 and 9, the player 7 and 4; the open card is the jack of diamonds
        let mut draw = Pcg64::new(&SeedSequence::new(&[0]));
        let game = Blackjack::default();
        let state = game.reset(&mut draw);
        assert_eq!(state, BlackjackState { player: hand(&[7, 4]), dealer: hand(&[10, 9]), shown: 10 });
        assert_eq!(game.observe(&state), [11, 10, 0]);
        assert_eq!((draw.drawn(), draw.half()), (3, None));
        assert_eq!(game.step(state, 0, &mut draw), Step { state, reward: -1.0, terminated: true });
    }

    #[test]
    fn who_busts_loses_at_once() {
        let mut draw = Pcg64::new(&SeedSequence::new(&[0]));
        let state = BlackjackState { player: hand(&[10, 10, 1]), ..BlackjackState::default() };
        let step = Blackjack::default().step(state, 1, &mut draw);
        assert_eq!((step.reward, step.terminated), (-1.0, true));
    }
}
