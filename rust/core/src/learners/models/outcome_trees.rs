//! Counted outcomes in the order in which they were first seen. Finding, counting or drawing an outcome takes a time
//! that grows with the logarithm of their number.

use super::ModelEntry;
use crate::memory::{AllocationError, RunMemory};

/// Marks a missing node and the end of a chain.
const NONE: u32 = u32::MAX;
/// The bit that is set in the number of an inner node.
const INNER: u32 = 1 << 31;

/// A leaf: an outcome of a pair and its count.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Leaf {
    entry: ModelEntry,
    count: u32,
    parent: u32,
    hash: u32,
    /// The next leaf whose hash leads to the same bucket.
    after: u32,
}

/// An inner node. The outcomes below its first child were seen before those below its second child.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Inner {
    /// The sum of the counts below the node.
    count: u32,
    parent: u32,
    children: [u32; 2],
}

/// The tree of a pair: its n leaves in their order. The first child of the root holds as many of them as the largest
/// power of two below n, and each subtree is divided in the same way. A tree whose number of leaves is a power of two
/// is perfect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Root {
    node: u32,
    leaves: u32,
}

impl Root {
    /// A tree without leaves.
    pub(super) const EMPTY: Self = Self { node: NONE, leaves: 0 };

    /// The number of outcomes.
    pub(super) fn len(self) -> u32 {
        self.leaves
    }
}

/// The trees of all pairs, with their nodes stored together, and an index of their leaves.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct OutcomeTrees {
    leaves: Vec<Leaf>,
    inner: Vec<Inner>,
    /// The first leaf of each chain. The number of buckets is a power of two.
    buckets: Vec<u32>,
}

impl OutcomeTrees {
    /// Trees without outcomes.
    pub(super) fn new() -> Self {
        Self { leaves: Vec::new(), inner: Vec::new(), buckets: vec![NONE] }
    }

    /// The number of outcomes of all trees.
    pub(super) fn len(&self) -> usize {
        self.leaves.len()
    }

    /// Makes room for this many more outcomes.
    pub(super) fn reserve(&mut self, additional: usize, memory: &mut RunMemory) -> Result<(), AllocationError> {
        if self.leaves.len().saturating_add(additional) >= INNER as usize {
            return Err(AllocationError::TooManyEntries);
        }
        memory.reserve(&mut self.leaves, additional)?;
        // Every leaf except the first of a tree adds an inner node.
        let nodes = self.leaves.len() + additional;
        let missing = nodes - self.inner.len();
        memory.reserve(&mut self.inner, missing)?;
        if nodes > self.buckets.len() {
            let buckets = nodes.next_power_of_two();
            self.buckets.clear();
            memory.reserve(&mut self.buckets, buckets)?;
            self.buckets.resize(buckets, NONE);
            for leaf in 0..self.leaves.len() {
                self.link(leaf as u32);
            }
        }
        Ok(())
    }

    /// Counts an outcome of a pair another `times` times. There must be room for it. If the count of the whole tree
    /// would exceed 32 bits, nothing is counted and the result is false.
    pub(super) fn count(&mut self, root: &mut Root, pair: usize, entry: ModelEntry, times: u32) -> bool {
        if self.total(*root).checked_add(times).is_none() {
            return false;
        }
        let hash = hash(pair, entry);
        let leaf = self.find(*root, hash, entry).unwrap_or_else(|| self.append(root, hash, entry));
        self.leaves[leaf as usize].count += times;
        let mut node = self.leaves[leaf as usize].parent;
        while node != NONE {
            let inner = &mut self.inner[(node & !INNER) as usize];
            inner.count += times;
            node = inner.parent;
        }
        true
    }

    /// The sum of the counts of a tree.
    #[inline]
    pub(super) fn total(&self, root: Root) -> u32 {
        if root.leaves == 0 { 0 } else { self.count_of(root.node) }
    }

    /// The first outcome at which the cumulative count exceeds `left`; `None` if the total count does not.
    #[inline]
    pub(super) fn at(&self, root: Root, mut left: u32) -> Option<ModelEntry> {
        if left >= self.total(root) {
            return None;
        }
        let mut node = root.node;
        while node & INNER != 0 {
            let [first, second] = self.inner[(node & !INNER) as usize].children;
            let before = self.count_of(first);
            node = if left < before {
                first
            } else {
                left -= before;
                second
            };
        }
        Some(self.leaves[node as usize].entry)
    }

    /// The outcome at `index` in a tree, and its count.
    pub(super) fn outcome(&self, root: Root, mut index: u32) -> (ModelEntry, u32) {
        let (mut node, mut leaves) = (root.node, root.leaves);
        while node & INNER != 0 {
            let [first, second] = self.inner[(node & !INNER) as usize].children;
            let before = largest_power_below(leaves);
            (node, leaves) = if index < before {
                (first, before)
            } else {
                index -= before;
                (second, leaves - before)
            };
        }
        let leaf = &self.leaves[node as usize];
        (leaf.entry, leaf.count)
    }

    #[inline]
    fn count_of(&self, node: u32) -> u32 {
        if node & INNER == 0 { self.leaves[node as usize].count } else { self.inner[(node & !INNER) as usize].count }
    }

    fn set_parent(&mut self, node: u32, parent: u32) {
        if node & INNER == 0 {
            self.leaves[node as usize].parent = parent;
        } else {
            self.inner[(node & !INNER) as usize].parent = parent;
        }
    }

    /// The leaf of an outcome.
    fn find(&self, root: Root, hash: u32, entry: ModelEntry) -> Option<u32> {
        let mut number = self.buckets[self.bucket(hash)];
        while number != NONE {
            let leaf = &self.leaves[number as usize];
            if leaf.hash == hash && leaf.entry == entry && self.root_of(number) == root.node {
                return Some(number);
            }
            number = leaf.after;
        }
        None
    }

    /// The root of the tree that a leaf is in.
    fn root_of(&self, leaf: u32) -> u32 {
        let (mut node, mut parent) = (leaf, self.leaves[leaf as usize].parent);
        while parent != NONE {
            (node, parent) = (parent, self.inner[(parent & !INNER) as usize].parent);
        }
        node
    }

    /// Adds a leaf at the end of a tree. A new inner node, whose children are the last perfect subtree and the leaf,
    /// takes the place of that subtree.
    fn append(&mut self, root: &mut Root, hash: u32, entry: ModelEntry) -> u32 {
        let leaf = self.leaves.len() as u32;
        self.leaves.push(Leaf { entry, count: 0, parent: NONE, hash, after: NONE });
        self.link(leaf);
        if root.leaves == 0 {
            *root = Root { node: leaf, leaves: 1 };
            return leaf;
        }
        let (mut perfect, mut leaves, mut parent) = (root.node, root.leaves, NONE);
        while !leaves.is_power_of_two() {
            leaves -= largest_power_below(leaves);
            parent = perfect;
            perfect = self.inner[(perfect & !INNER) as usize].children[1];
        }
        let new = INNER | self.inner.len() as u32;
        self.inner.push(Inner { count: self.count_of(perfect), parent, children: [perfect, leaf] });
        self.set_parent(perfect, new);
        self.set_parent(leaf, new);
        if parent == NONE {
            root.node = new;
        } else {
            self.inner[(parent & !INNER) as usize].children[1] = new;
        }
        root.leaves += 1;
        leaf
    }

    /// The number of inner nodes above the first leaf.
    #[cfg(test)]
    pub(super) fn depth(&self) -> usize {
        let parent = |&node: &u32| Some(self.inner[(node & !INNER) as usize].parent).filter(|&node| node != NONE);
        let first = Some(self.leaves[0].parent).filter(|&node| node != NONE);
        std::iter::successors(first, parent).count()
    }

    #[inline]
    fn bucket(&self, hash: u32) -> usize {
        hash as usize & (self.buckets.len() - 1)
    }

    /// Adds a leaf to its chain.
    fn link(&mut self, leaf: u32) {
        let bucket = self.bucket(self.leaves[leaf as usize].hash);
        self.leaves[leaf as usize].after = std::mem::replace(&mut self.buckets[bucket], leaf);
    }
}

/// The largest power of two below a number of at least 2.
fn largest_power_below(number: u32) -> u32 {
    1 << (number - 1).ilog2()
}

/// A hash that is the same for equal entries of a pair. The floats 0 and -0 are equal although their bits differ.
fn hash(pair: usize, ModelEntry { reward, next }: ModelEntry) -> u32 {
    let mut mixed = (reward + 0.0).to_bits();
    for value in [pair as u64, next.map_or(0, |next| u64::from(next) + 1)] {
        mixed = (mixed ^ (mixed >> 32)).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ value;
    }
    mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (mixed >> 32) as u32
}
