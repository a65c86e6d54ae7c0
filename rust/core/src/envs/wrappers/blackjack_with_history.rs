//! Blackjack that remembers each draw, for whoever wants to see the cards themselves.

use crate::envs::toy_text::{Blackjack, BlackjackState};
use crate::envs::{Env, Step};
use crate::random::Rng;

/// More than any game draws: 21 aces and the dealer's hand.
const MOST: usize = 48;
const BITS: usize = 4;
const PER_WORD: usize = u64::BITS as usize / BITS;

/// The same game, whose state remembers what was drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlackjackWithHistory(pub Blackjack);

/// The table, and every draw since the deal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DealHistory {
    /// The hands as far as they matter.
    pub hands: BlackjackState,
    count: usize,
    words: [u64; MOST / PER_WORD],
}

impl DealHistory {
    /// What was drawn, in its order: the dealer's two cards and the player's as places in the deck, the open card's
    /// suit, its face if it is a ten, the cards that the player took, those that the dealer took.
    pub fn draws(&self) -> impl Iterator<Item = usize> {
        (0..self.count).map(|place| (self.words[place / PER_WORD] >> (place % PER_WORD * BITS)) as usize % (1 << BITS))
    }
}

/// A stream that writes down what it gives.
struct RecordingRng<'a, D>(&'a mut D, &'a mut DealHistory);

impl<D: Rng> Rng for RecordingRng<'_, D> {
    fn random(&mut self) -> f64 {
        self.0.random()
    }

    #[inline]
    fn integers(&mut self, below: u32) -> u32 {
        let number = self.0.integers(below);
        let DealHistory { count, words, .. } = self.1;
        if *count < MOST {
            words[*count / PER_WORD] |= u64::from(number) << (*count % PER_WORD * BITS);
            *count += 1;
        }
        number
    }
}

impl Env for BlackjackWithHistory {
    type State = DealHistory;
    type Action = usize;
    type Observation = [u32; 3];

    #[inline]
    fn num_actions(&self) -> usize {
        self.0.num_actions()
    }

    #[inline]
    fn reset(&self, rng: &mut impl Rng) -> DealHistory {
        let mut dealt = DealHistory::default();
        dealt.hands = self.0.reset(&mut RecordingRng(rng, &mut dealt));
        dealt
    }

    #[inline]
    fn step(&self, mut dealt: DealHistory, action: usize, rng: &mut impl Rng) -> Step<DealHistory> {
        let Step { state, reward, terminated } = self.0.step(dealt.hands, action, &mut RecordingRng(rng, &mut dealt));
        dealt.hands = state;
        Step { state: dealt, reward, terminated }
    }

    #[inline]
    fn observe(&self, dealt: &DealHistory) -> [u32; 3] {
        self.0.observe(&dealt.hands)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envs::toy_text::{DECK, Hand};
    use crate::random::{Pcg64, SeedSequence};

    #[test]
    fn the_draws_make_the_hands() {
        for seed in 0..500 {
            let mut rng = Pcg64::new(&SeedSequence::new(&[seed]));
            let mut same = rng.clone();
            let game = BlackjackWithHistory(Blackjack::default());
            let (mut dealt, mut hands) = (game.reset(&mut rng), game.0.reset(&mut same));
            for action in [1, 1, 0] {
                let step = game.step(dealt, action, &mut rng);
                let expected = game.0.step(hands, action, &mut same);
                assert_eq!((step.state.hands, step.reward), (expected.state, expected.reward));
                (dealt, hands) = (step.state, expected.state);
                if step.terminated {
                    break;
                }
            }
            let mut draws = dealt.draws().collect::<Vec<_>>();
            let picture = if hands.shown == 10 { 4..6 } else { 4..5 };
            draws.drain(picture);
            let taken = hands.player.cards as usize - 2;
            let hand = |places: &[&[usize]]| {
                places.concat().iter().fold(Hand::default(), |hand, &place| hand.with(DECK[place]))
            };
            assert_eq!(hands.dealer, hand(&[&draws[..2], &draws[4 + taken..]]));
            assert_eq!(hands.player, hand(&[&draws[2..4 + taken]]));
        }
    }
}
