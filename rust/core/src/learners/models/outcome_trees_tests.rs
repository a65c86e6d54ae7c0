//! Tests of the trees of counted outcomes.

use proptest::prelude::*;

use super::ModelEntry;
use super::outcome_trees::{OutcomeTrees, Root};
use crate::memory::{MemoryRoom, RunMemory};

fn with_room(outcomes: usize) -> OutcomeTrees {
    let mut trees = OutcomeTrees::new();
    trees.reserve(outcomes, &mut RunMemory::new(MemoryRoom::unlimited())).expect("a few outcomes");
    trees
}

#[test]
fn zeros_of_both_signs_are_one_outcome() {
    let (mut trees, mut root) = (with_room(2), Root::EMPTY);
    for reward in [0.0, -0.0] {
        assert!(trees.count(&mut root, 0, ModelEntry { reward, next: None }, 1));
    }
    assert_eq!((root.len(), trees.total(root)), (1, 2));
}

#[test]
fn a_tree_is_as_deep_as_the_logarithm_of_its_outcomes() {
    let (mut trees, mut root) = (with_room(1000), Root::EMPTY);
    for outcome in 1..=1000_u32 {
        assert!(trees.count(&mut root, 0, ModelEntry { reward: f64::from(outcome), next: None }, 1));
        assert_eq!(trees.depth() as u32, outcome.next_power_of_two().ilog2());
    }
}

#[test]
fn a_full_count_stays() {
    let (mut trees, mut root) = (with_room(2), Root::EMPTY);
    let entry = |reward| ModelEntry { reward, next: None };
    assert!(trees.count(&mut root, 0, entry(1.0), u32::MAX - 1));
    assert!(!trees.count(&mut root, 0, entry(2.0), 2));
    assert!(trees.count(&mut root, 0, entry(2.0), 1));
    assert_eq!(trees.at(root, u32::MAX - 2), Some(entry(1.0)));
    assert_eq!(trees.at(root, u32::MAX - 1), Some(entry(2.0)));
    assert_eq!(trees.at(root, u32::MAX), None);
}

proptest! {
    #[test]
    fn outcomes_are_counted_and_drawn_as_from_lists(seen in prop::collection::vec((0..3_usize, 0..40_u8), 0..200)) {
        let mut trees = OutcomeTrees::new();
        let mut memory = RunMemory::new(MemoryRoom::unlimited());
        let mut roots = [Root::EMPTY; 3];
        let mut lists: [Vec<(ModelEntry, u32)>; 3] = Default::default();
        for (pair, outcome) in seen {
            let entry = ModelEntry { reward: f64::from(outcome / 2), next: Some(u32::from(outcome % 2)) };
            trees.reserve(1, &mut memory).expect("a few outcomes");
            trees.count(&mut roots[pair], pair, entry, 1);
            match lists[pair].iter_mut().find(|known| known.0 == entry) {
                Some(known) => known.1 += 1,
                None => lists[pair].push((entry, 1)),
            }
        }
        for (root, list) in roots.into_iter().zip(lists) {
            let found: Vec<_> = (0..root.len()).map(|index| trees.outcome(root, index)).collect();
            prop_assert_eq!(&found, &list);
            let drawn: Vec<_> = (0..trees.total(root)).filter_map(|left| trees.at(root, left)).collect();
            let expected: Vec<_> = list.iter().flat_map(|&(entry, count)| vec![entry; count as usize]).collect();
            prop_assert_eq!(drawn, expected);
        }
    }
}
