//! Blackjack that remembers each draw, for whoever wants to see the cards themselves.

use super::{Blackjack, BlackjackState};
use crate::env::{Env, Step};
use crate::random::Draw;

/// More than any game draws: 21 aces and the dealer's hand.
const MOST: usize = 48;
const BITS: usize = 4;
const PER_WORD: usize = u64::BITS as usize / BITS;

/// The same game, whose state remembers what was drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dealing(pub Blackjack);

/// The table, and every draw since the deal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dealt {
    /// The hands as far as they matter.
    pub hands: BlackjackState,
    count: usize,
    words: [u64; MOST / PER_WORD],
}

impl Dealt {
    /// What was drawn, in its order: the dealer's two cards and the player's as places in the deck, the open card's
    /// suit, its face if it is a ten, the cards that the player took, those that the dealer took.
    pub fn drawn(&self) -> impl Iterator<Item = usize> {
        (0..self.count).map(|place| (self.words[place / PER_WORD] >> (place % PER_WORD * BITS)) as usize % (1 << BITS))
    }
}

/// A stream that writes down what it gives.
struct Noting<'a, D>(&'a mut D, &'a mut Dealt);

impl<D: Draw> Draw for Noting<'_, D> {
    fn random(&mut self) -> f64 {
        self.0.random()
    }

    #[inline]
    fn integers(&mut self, below: u32) -> u32 {
        let number = self.0.integers(below);
        let Dealt { count, words, .. } = self.1;
        if *count < MOST {
            words[*count / PER_WORD] |= u64::from(number) << (*count % PER_WORD * BITS);
            *count += 1;
        }
        number
    }
}

impl Env for Dealing {
    type State = Dealt;
    type Action = usize;
    type Observation = [u32; 3];

    #[inline]
    fn actions(&self) -> usize {
        self.0.actions()
    }

    #[inline]
    fn reset(&self, draw: &mut impl Draw) -> Dealt {
        let mut dealt = Dealt::default();
        dealt.hands = self.0.reset(&mut Noting(draw, &mut dealt));
        dealt
    }

    #[inline]
    fn step(&self, mut dealt: Dealt, action: usize, draw: &mut impl Draw) -> Step<Dealt> {
        let Step { state, reward, terminated } = self.0.step(dealt.hands, action, &mut Noting(draw, &mut dealt));
        dealt.hands = state;
        Step { state: dealt, reward, terminated }
    }

    #[inline]
    fn observe(&self, dealt: &Dealt) -> [u32; 3] {
        self.0.observe(&dealt.hands)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envs::{DECK, Hand};
    use crate::random::{Pcg64, SeedSequence};

    #[test]
    fn the_draws_make_the_hands() {
        for seed in 0..500 {
            let mut draw = Pcg64::new(&SeedSequence::new(&[seed]));
            let mut same = draw.clone();
            let game = Dealing(Blackjack::default());
            let (mut dealt, mut hands) = (game.reset(&mut draw), game.0.reset(&mut same));
            for action in [1, 1, 0] {
                let step = game.step(dealt, action, &mut draw);
                let expected = game.0.step(hands, action, &mut same);
                assert_eq!((step.state.hands, step.reward), (expected.state, expected.reward));
                (dealt, hands) = (step.state, expected.state);
                if step.terminated {
                    break;
                }
            }
            let mut drawn = dealt.drawn().collect::<Vec<_>>();
            let picture = if hands.shown == 10 { 4..6 } else { 4..5 };
            drawn.drain(picture);
            let taken = hands.player.cards as usize - 2;
            let hand = |places: &[&[usize]]| {
                places.concat().iter().fold(Hand::default(), |hand, &place| hand.with(DECK[place]))
            };
            assert_eq!(hands.dealer, hand(&[&drawn[..2], &drawn[4 + taken..]]));
            assert_eq!(hands.player, hand(&[&drawn[2..4 + taken]]));
        }
    }
}
