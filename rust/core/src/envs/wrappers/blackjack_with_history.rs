//! Blackjack with a record of the cards dealt, for rendering and for Python's view of the state.

use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::envs::toy_text::{Blackjack, BlackjackState};
use crate::envs::{Env, Step};
use crate::random::Rng;

/// An upper bound on the draws of a game: 21 aces and the dealer's hand.
const MAX_DRAWS: usize = 48;
/// The bits of one draw, and the draws per word.
const BITS: usize = 4;
const PER_WORD: usize = u64::BITS as usize / BITS;

/// Blackjack whose state records all random draws of the episode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BlackjackWithHistory(pub Blackjack);

/// The hands, and all draws since the reset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DealHistory {
    /// The hands of both sides.
    pub hands: BlackjackState,
    count: usize,
    words: [u64; MAX_DRAWS / PER_WORD],
}

impl DealHistory {
    /// The draws in their order: the dealer's two cards and the player's two as indices into the deck, the suit of the
    /// face-up card, its face if it is a ten, the player's further cards, the dealer's further cards.
    pub fn draws(&self) -> impl Iterator<Item = usize> {
        (0..self.count).map(|index| (self.words[index / PER_WORD] >> (index % PER_WORD * BITS)) as usize % (1 << BITS))
    }
}

impl Persist for DealHistory {
    fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        self.hands.persist(checkpoint)?;
        checkpoint.index(&mut self.count, MAX_DRAWS + 1, "number of draws")?;
        self.words.persist(checkpoint)
    }
}

/// A generator that records the integers it draws.
struct RecordingRng<'a, R>(&'a mut R, &'a mut DealHistory);

impl<R: Rng> Rng for RecordingRng<'_, R> {
    fn random(&mut self) -> f64 {
        self.0.random()
    }

    #[inline]
    fn integers(&mut self, below: u32) -> u32 {
        let number = self.0.integers(below);
        let DealHistory { count, words, .. } = self.1;
        if *count < MAX_DRAWS {
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
        let mut history = DealHistory::default();
        history.hands = self.0.reset(&mut RecordingRng(rng, &mut history));
        history
    }

    #[inline]
    fn step(&self, mut history: DealHistory, action: usize, rng: &mut impl Rng) -> Step<DealHistory> {
        let Step { state, reward, terminated } =
            self.0.step(history.hands, action, &mut RecordingRng(rng, &mut history));
        history.hands = state;
        Step { state: history, reward, terminated }
    }

    #[inline]
    fn observe(&self, history: &DealHistory) -> [u32; 3] {
        self.0.observe(&history.hands)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::envs::toy_text::{DECK, Hand};
    use crate::random::{Pcg64, SeedSequence};

    #[test]
    fn the_draws_reconstruct_the_hands() {
        for seed in 0..500 {
            let mut rng = Pcg64::new(&SeedSequence::new(&[seed]));
            let mut same = rng.clone();
            let game = BlackjackWithHistory(Blackjack::default());
            let (mut history, mut hands) = (game.reset(&mut rng), game.0.reset(&mut same));
            for action in [1, 1, 0] {
                let step = game.step(history, action, &mut rng);
                let expected = game.0.step(hands, action, &mut same);
                assert_eq!((step.state.hands, step.reward), (expected.state, expected.reward));
                (history, hands) = (step.state, expected.state);
                if step.terminated {
                    break;
                }
            }
            let mut draws = history.draws().collect::<Vec<_>>();
            let picture = if hands.shown == 10 { 4..6 } else { 4..5 };
            draws.drain(picture);
            let taken = hands.player.cards as usize - 2;
            let hand = |indices: &[&[usize]]| {
                indices.concat().iter().fold(Hand::default(), |hand, &index| hand.with(DECK[index]))
            };
            assert_eq!(hands.dealer, hand(&[&draws[..2], &draws[4 + taken..]]));
            assert_eq!(hands.player, hand(&[&draws[2..4 + taken]]));
        }
    }
}
