//! The generator of an environment draws the numbers of `numpy.random.Generator`.

use std::cell::RefCell;

use qtab_core::random::{Pcg64, SeedSequence};
use qtab_env::host::{BitGenerator, Environment, Episode, RandomBits};
use qtab_env::{Env, Exported, Generator, Step};

/// The integers, the floats and the last integer of a round of draws.
type Draws = ([i64; 6], [f64; 2], i64);

/// Three rounds of `rng = np.random.default_rng(5)`: `integers` of (-3, 4), (0, 2**32), (0, 2**32 + 5), (-2**63, 2**63 - 1),
/// (7, 8), (0, 3 * 2**61), then `random()` and `uniform(-2, 3)`, then `integers(0, 6)`.
const NUMPY: [Draws; 3] = [
    (
        [1, 3_457_461_230, 3_470_079_273, 282_706_702_330_408_383, 7, 1_977_039_342_899_601_836],
        [0.053_930_702_381_656_426, -0.083_155_596_072_408_85],
        3,
    ),
    (
        [-1, 562_902_478, 209_412_773, 9_208_174_042_313_963_663, 7, 4_512_782_266_146_329_695],
        [0.234_510_201_669_823_95, 0.174_737_761_125_710_38],
        0,
    ),
    (
        [-2, 4_184_097_840, 3_855_495_973, 6_349_941_852_995_933_656, 7, 2_714_470_656_117_583_781],
        [0.493_023_018_731_742_6, 1.383_446_759_155_330_3],
        3,
    ),
];

struct Bits(Pcg64);

impl BitGenerator for Bits {
    fn next_u64(&mut self) -> u64 {
        self.0.next_u64()
    }

    fn next_u32(&mut self) -> u32 {
        self.0.next_u32()
    }
}

thread_local! {
    static DRAWN: RefCell<Vec<Draws>> = const { RefCell::new(Vec::new()) };
}

/// Its reset draws, and tells what it has drawn.
struct Drawing;

impl Env for Drawing {
    type State = ();
    type Number = f32;

    fn num_actions(&self) -> usize {
        1
    }

    fn observation_bounds(&self) -> Vec<(f32, f32)> {
        vec![(0.0, 1.0)]
    }

    fn reset(&self, rng: &mut Generator<'_>) {
        let first = [
            rng.integers(-3, 4),
            rng.integers(0, 1 << 32),
            rng.integers(0, (1 << 32) + 5),
            rng.integers(i64::MIN, i64::MAX),
            rng.integers(7, 8),
            rng.integers(0, 3 << 61),
        ];
        let floats = [rng.random(), rng.uniform(-2.0, 3.0)];
        let last = rng.integers(0, 6);
        DRAWN.with_borrow_mut(|drawn| drawn.push((first, floats, last)));
    }

    fn step(&self, (): &(), _: usize, _: &mut Generator<'_>) -> Step<()> {
        Step::new((), 0.0, true)
    }

    fn observe(&self, (): &(), observation: &mut [f32]) {
        observation.fill(0.5);
    }
}

#[test]
#[expect(unsafe_code, reason = "a table is given by its address")]
fn the_numbers_are_those_of_numpy() {
    let exported = Exported::new(|| Drawing);
    // SAFETY: the table is that of an environment of this crate, which is never dropped.
    let environment = unsafe { Environment::new(exported.table()) }.expect("a valid table");
    let mut episode = Episode::new(&environment).expect("memory suffices");
    let mut bits = Bits(Pcg64::new(&SeedSequence::new(&[5])));
    for _ in 0..NUMPY.len() {
        episode.reset(&mut RandomBits::new(&mut bits)).expect("a reset");
    }
    DRAWN.with_borrow(|drawn| assert_eq!(drawn.as_slice(), NUMPY));
}
