//! A hand of blackjack.

/// The value of a ten and of a face card.
pub(super) const TEN: u32 = 10;
const ACE: u32 = 1;
const MOST: u32 = 21;

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

#[cfg(test)]
mod tests {
    use super::*;

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
}
