//! A priority queue of state-action pairs.

use crate::StopFlag;
use crate::checkpoint::{Checkpoint, CheckpointError, Persist};
use crate::memory::{AllocationError, check_indices, filled, with_capacity};

/// Marks a pair that is not in the queue.
const ABSENT: u32 = u32::MAX;

/// A binary heap of pairs by their indices, each at most once. The pair with the highest priority comes first, and
/// among equal priorities the one with the lowest index. The order thus depends only on the contents of the queue.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::learners) struct PriorityQueue {
    heap: Vec<u32>,
    /// The position of each pair in the heap.
    places: Vec<u32>,
    priorities: Vec<f64>,
}

impl PriorityQueue {
    /// An empty queue with room for this many pairs.
    pub(in crate::learners) fn new(pairs: usize, stop: &StopFlag<'_>) -> Result<Self, AllocationError> {
        check_indices(pairs)?;
        let (heap, places) = (with_capacity(pairs)?, filled(&ABSENT, pairs, stop)?);
        Ok(Self { heap, places, priorities: filled(&0.0, pairs, stop)? })
    }

    /// Inserts a pair, or raises its priority. A priority that is not higher than the current one is ignored.
    #[inline]
    pub(in crate::learners) fn insert(&mut self, pair: usize, priority: f64) {
        let place = self.places[pair];
        if place == ABSENT {
            self.priorities[pair] = priority;
            self.heap.push(pair as u32);
            self.sift_up(self.heap.len() - 1);
        } else if priority > self.priorities[pair] {
            self.priorities[pair] = priority;
            self.sift_up(place as usize);
        }
    }

    /// Removes and returns the first pair.
    #[inline]
    pub(in crate::learners) fn pop(&mut self) -> Option<usize> {
        let (&first, &last) = (self.heap.first()?, self.heap.last()?);
        self.heap.pop();
        self.places[first as usize] = ABSENT;
        if first != last {
            self.put(0, last);
            self.sift_down();
        }
        Some(first as usize)
    }

    /// Whether one pair comes before another.
    #[inline]
    fn precedes(&self, one: u32, other: u32) -> bool {
        let (first, second) = (self.priorities[one as usize], self.priorities[other as usize]);
        first > second || (first == second && one < other)
    }

    #[inline]
    fn put(&mut self, place: usize, pair: u32) {
        self.heap[place] = pair;
        self.places[pair as usize] = place as u32;
    }

    fn sift_up(&mut self, mut place: usize) {
        let pair = self.heap[place];
        while place > 0 {
            let parent = (place - 1) / 2;
            if !self.precedes(pair, self.heap[parent]) {
                break;
            }
            self.put(place, self.heap[parent]);
            place = parent;
        }
        self.put(place, pair);
    }

    fn sift_down(&mut self) {
        let (mut place, pair) = (0, self.heap[0]);
        loop {
            let (left, right) = (2 * place + 1, 2 * place + 2);
            let Some(&first) = self.heap.get(left) else { break };
            let child = match self.heap.get(right) {
                Some(&second) if self.precedes(second, first) => right,
                _ => left,
            };
            if !self.precedes(self.heap[child], pair) {
                break;
            }
            self.put(place, self.heap[child]);
            place = child;
        }
        self.put(place, pair);
    }

    /// Saves or restores the pairs with their priorities, in the order of their indices.
    pub(in crate::learners) fn persist(&mut self, checkpoint: &mut Checkpoint<'_>) -> Result<(), CheckpointError> {
        let mut count = self.heap.len();
        checkpoint.index(&mut count, self.places.len() + 1, "number of pairs in the queue")?;
        if checkpoint.is_restoring() {
            self.heap.clear();
            self.places.fill(ABSENT);
        }
        let mut held =
            (0..self.places.len()).filter(|&pair| self.places[pair] != ABSENT).collect::<Vec<_>>().into_iter();
        for _ in 0..count {
            let mut pair = held.next().unwrap_or_default() as u32;
            checkpoint.index_u32(&mut pair, self.places.len(), "pair in the queue")?;
            let mut priority = self.priorities[pair as usize];
            priority.persist(checkpoint)?;
            if checkpoint.is_restoring() {
                checkpoint.check(self.places[pair as usize] == ABSENT && !priority.is_nan(), "pair in the queue")?;
                self.insert(pair as usize, priority);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn pairs_beyond_32_bits_are_refused() {
        assert_eq!(PriorityQueue::new(1 << 32, &StopFlag::new()), Err(AllocationError::TooManyEntries));
    }

    #[test]
    fn the_higher_priority_of_a_pair_stays() {
        let mut queue = PriorityQueue::new(4, &StopFlag::new()).expect("four pairs");
        for (pair, priority) in [(3, 1.0), (1, 2.0), (3, 5.0), (1, 0.5), (0, 2.0)] {
            queue.insert(pair, priority);
        }
        assert_eq!([queue.pop(), queue.pop(), queue.pop(), queue.pop()], [Some(3), Some(0), Some(1), None]);
    }

    proptest! {
        #[test]
        fn pairs_come_out_in_order(inserted in prop::collection::vec((0..20_usize, 0..6_u8), 0..60), pops in 0..30_usize) {
            let mut queue = PriorityQueue::new(20, &StopFlag::new()).expect("a few pairs");
            let mut expected: Vec<(u8, usize)> = Vec::new();
            for &(pair, priority) in &inserted {
                queue.insert(pair, f64::from(priority));
                match expected.iter_mut().find(|known| known.1 == pair) {
                    Some(known) => known.0 = known.0.max(priority),
                    None => expected.push((priority, pair)),
                }
            }
            expected.sort_by_key(|&(priority, pair)| (u8::MAX - priority, pair));
            for &(_, pair) in expected.iter().take(pops) {
                prop_assert_eq!(queue.pop(), Some(pair));
            }
            let mut bytes = Vec::new();
            queue.persist(&mut Checkpoint::save(&mut bytes)).expect("memory suffices");
            let mut restored = PriorityQueue::new(20, &StopFlag::new()).expect("a few pairs");
            restored.persist(&mut Checkpoint::restore(&bytes)).expect("the bytes are complete");
            for &(_, pair) in expected.iter().skip(pops) {
                prop_assert_eq!(queue.pop(), Some(pair));
                prop_assert_eq!(restored.pop(), Some(pair));
            }
            prop_assert_eq!((queue.pop(), restored.pop()), (None, None));
        }
    }
}
