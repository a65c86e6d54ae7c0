//! A hand of blackjack.

use crate::persist_struct;

/// The value of a ten and of a face card.
pub(super) const TEN: u32 = 10;
const ACE: u32 = 1;
/// The highest sum that is not a bust.
const MAX_SUM: u32 = 21;

/// The cards of one side, reduced to the quantities that matter to the rules.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Hand {
    /// The sum, with aces as 1.
    pub total: u32,
    /// The number of cards.
    pub cards: u32,
    /// Whether there is an ace.
    pub ace: bool,
}

persist_struct!(Hand { total, cards, ace });

impl Hand {
    /// The hand with one more card.
    #[inline]
    #[must_use]
    pub fn with(self, card: u32) -> Self {
        Self { total: self.total + card, cards: self.cards + 1, ace: self.ace || card == ACE }
    }

    /// A hand of three or more cards with this sum, with or without a usable ace; `None` if there is no such hand. The
    /// individual cards do not matter.
    pub fn showing(sum: u32, usable_ace: bool) -> Option<Self> {
        let total = sum.checked_sub(if usable_ace { 10 } else { 0 })?;
        let hand = Self { total, cards: 3, ace: usable_ace };
        (hand.sum() == sum && hand.usable_ace() == usable_ace && total > 0).then_some(hand)
    }

    /// Whether an ace can count as 11.
    #[inline]
    pub fn usable_ace(&self) -> bool {
        self.ace && self.total + 10 <= MAX_SUM
    }

    /// The sum, with an ace as 11 if possible.
    #[inline]
    pub fn sum(&self) -> u32 {
        if self.usable_ace() { self.total + 10 } else { self.total }
    }

    /// Whether the sum exceeds 21.
    #[inline]
    pub fn is_bust(&self) -> bool {
        self.sum() > MAX_SUM
    }

    /// The final score: the sum, or 0 for a bust.
    #[inline]
    pub fn score(&self) -> u32 {
        if self.is_bust() { 0 } else { self.sum() }
    }

    /// Whether the hand is exactly an ace and a ten.
    #[inline]
    pub fn is_natural(&self) -> bool {
        self.cards == 2 && self.ace && self.total == ACE + TEN
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hand(cards: &[u32]) -> Hand {
        cards.iter().fold(Hand::default(), |hand, &card| hand.with(card))
    }

    #[test]
    fn an_ace_counts_as_eleven_unless_that_would_bust() {
        assert_eq!(hand(&[1, 7]).sum(), 18);
        assert_eq!(hand(&[1, 1]).sum(), 12);
        assert_eq!(hand(&[1, 7, 10]).sum(), 18);
        assert!(!hand(&[1, 7, 10]).usable_ace());
        assert!(hand(&[10, 10, 2]).is_bust());
        assert_eq!(hand(&[10, 10, 2]).score(), 0);
    }

    #[test]
    fn a_natural_is_an_ace_and_a_ten_only() {
        assert!(hand(&[10, 1]).is_natural());
        assert!(!hand(&[1, 4, 6]).is_natural());
        assert!(!hand(&[5, 6]).is_natural());
    }
}
