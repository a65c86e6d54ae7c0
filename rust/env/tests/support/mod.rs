//! An environment for the tests, and a generator.

use qtab_env::host::BitGenerator;
use qtab_env::{Env, Exported, Generator, Step, Table};

/// A walk on the numbers from 0 to 6.
pub(crate) struct Walk {
    /// Panics at this position.
    pub(crate) panics_at: Option<i64>,
}

impl Env for Walk {
    type State = i64;
    type Number = i64;

    fn num_actions(&self) -> usize {
        2
    }

    fn observation_bounds(&self) -> Vec<(i64, i64)> {
        vec![(0, 6)]
    }

    fn max_episode_steps(&self) -> Option<u32> {
        Some(20)
    }

    fn has_action_mask(&self) -> bool {
        true
    }

    fn reset(&self, rng: &mut Generator<'_>) -> i64 {
        rng.integers(2, 5)
    }

    fn step(&self, state: &i64, action: usize, rng: &mut Generator<'_>) -> Step<i64> {
        assert!(Some(*state) != self.panics_at, "a position that is not supported");
        let forward = rng.random() < if action == 1 { 0.9 } else { 0.1 };
        let state = if forward { state + 1 } else { state - 1 };
        Step::new(state, f64::from(u8::from(state == 6)), state == 0 || state == 6)
    }

    fn observe(&self, state: &i64, observation: &mut [i64]) {
        observation[0] = *state;
    }

    /// At 3, only the second action is available.
    fn action_mask(&self, state: &i64, mask: &mut [bool]) {
        mask[0] = *state != 3;
    }
}

/// The table of a walk.
pub(crate) fn walk() -> Table {
    table(Walk { panics_at: None })
}

/// The table of an environment, which is never dropped.
pub(crate) fn table(env: impl Env) -> Table {
    let address = Exported::new(|| env).table();
    // SAFETY: the environment was made, and its table is never dropped.
    unsafe { *address }
}

/// `SplitMix64` (G. Steele, D. Lea, C. Flood, "Fast splittable pseudorandom number generators", 2014).
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SplitMix(pub(crate) u64);

impl BitGenerator for SplitMix {
    fn next_u64(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        bits ^ (bits >> 31)
    }

    fn next_u32(&mut self) -> u32 {
        (self.next_u64() >> 32) as u32
    }
}
