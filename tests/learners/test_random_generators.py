"""The agent's random generators draw what NumPy's draw, for any seed and in any order."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from qtab._core import AgentRng

EDGES = [0, 1, 2**31, 2**32 - 1, 2**32, 2**64 - 1, 2**64, 2**64 + 1, 2**96, 2**128 - 1, 2**128, 2**128 + 1, 2**200 + 3]
PCG64_SEEDS = st.sampled_from(EDGES) | st.integers(0, 2**160)
MT19937_SEEDS = st.sampled_from([0, 1, 2**31, 2**32 - 1]) | st.integers(0, 2**32 - 1)
BOUNDS = st.sampled_from([(-1.0, 1.0), (-0.6, -0.4), (0.0, 1.0), (-0.0, 0.0), (1e-300, 3.0)]) | st.tuples(
    st.floats(-1e6, 1e6), st.floats(-1e6, 1e6)
).map(sorted).map(tuple)
DRAWS = st.lists(
    st.just(("random",)) | st.tuples(st.just("integers"), st.integers(1, 20)) | st.tuples(st.just("uniform"), BOUNDS),
    max_size=60,
)


class NumpyPcg64:
    def __init__(self, seed):
        self.generator = np.random.default_rng(np.random.SeedSequence(seed).spawn(1)[0])
        self.random = self.generator.random
        self.uniform = self.generator.uniform

    def integers(self, below):
        return self.generator.integers(0, below)


class NumpyMt19937:
    def __init__(self, seed):
        self.generator = np.random.RandomState(seed)
        self.random = self.generator.random_sample
        self.uniform = self.generator.uniform

    def integers(self, below):
        return self.generator.randint(0, below)


def pcg64(seed: int) -> tuple[Any, Any]:
    return AgentRng("PCG64", seed), NumpyPcg64(seed)


def mt19937(seed: int) -> tuple[Any, Any]:
    return AgentRng("MT19937", seed), NumpyMt19937(seed)


def draw(stream, request):
    match request:
        case ("random",):
            return stream.random()
        case ("integers", below):
            return stream.integers(below)
        case ("uniform", (low, high)):
            return stream.uniform(low, high)


# Every kind of draw, twice: a buffered half or a rejected word that is left over would show.
TAIL = 2 * [("integers", 7), ("random",), ("integers", 3), ("uniform", (-1.0, 1.0)), ("integers", 20), ("integers", 2)]


def assert_same_draws(ours, numpys, requests):
    for request in [*requests, *TAIL]:
        mine, theirs = draw(ours, request), draw(numpys, request)
        assert np.float64(mine).tobytes() == np.float64(theirs).tobytes(), request


@given(seed=PCG64_SEEDS, requests=DRAWS)
def test_pcg64_draws_what_numpy_draws_in_any_order(seed, requests):
    assert_same_draws(*pcg64(seed), requests)


@given(seed=MT19937_SEEDS, requests=DRAWS)
def test_mt19937_draws_what_numpy_draws_in_any_order(seed, requests):
    assert_same_draws(*mt19937(seed), requests)


@pytest.mark.parametrize("pair", [pcg64, mt19937])
@pytest.mark.parametrize("below", range(1, 21))
def test_thousands_of_integers_equal_numpys(pair, below):
    ours, numpys = pair(7)
    assert [ours.integers(below) for _ in range(3000)] == [numpys.integers(below) for _ in range(3000)]
    assert ours.random() == numpys.random()


@pytest.mark.parametrize("pair", [pcg64, mt19937])
@pytest.mark.parametrize("below", [2**31 - 1, 2**31 + 1, 3 * 2**30, 2**32 - 1])
def test_large_bounds_reject_the_words_that_numpy_rejects(pair, below):
    ours, numpys = pair(11)
    assert [ours.integers(below) for _ in range(500)] == [numpys.integers(below) for _ in range(500)]
    assert ours.random() == numpys.random()


@pytest.mark.parametrize("pair", [pcg64, mt19937])
def test_a_bound_of_1_draws_no_random_numbers(pair):
    ours, numpys = pair(3)
    assert [ours.integers(1) for _ in range(10)] == 10 * [0]
    assert ours.random() == numpys.random()


@pytest.mark.parametrize("pair", [pcg64, mt19937])
def test_hundreds_of_thousands_of_floats_equal_numpys(pair):
    ours, numpys = pair(2**32 - 1)
    theirs = numpys.generator.random(200_000)
    mine = np.array([ours.random() for _ in range(200_000)])
    assert mine.tobytes() == theirs.tobytes()


@pytest.mark.parametrize("seed", EDGES)
def test_seeds_of_any_size_seed_pcg64_as_numpy_does(seed):
    ours, numpys = pcg64(seed)
    assert [ours.random() for _ in range(20)] == [numpys.random() for _ in range(20)]


def test_mt19937_is_seeded_as_numpys_legacy_generator():
    np.random.seed(5)  # noqa: NPY002 - the article's way
    assert AgentRng("MT19937", 5).random() == np.random.random()  # noqa: NPY002
    assert AgentRng("MT19937", 5).random() != np.random.Generator(np.random.MT19937(5)).random()


@pytest.mark.parametrize(
    ("seed", "error", "message"),
    [
        (-1, ValueError, "seed must be a non-negative integer, got -1"),
        (-(2**200), ValueError, "seed must be a non-negative integer, got -16069"),
        (1.5, TypeError, "seed must be an integer, got 1.5"),
        ("1", TypeError, "seed must be an integer, got '1'"),
    ],
)
def test_a_seed_that_is_no_non_negative_integer_is_refused(seed, error, message):
    with pytest.raises(error, match=message):
        AgentRng("PCG64", seed)


def test_mt19937_takes_seeds_of_32_bits():
    with pytest.raises(ValueError, match=r"seed must lie in 0 to 2\*\*32 - 1 for MT19937"):
        AgentRng("MT19937", 2**32)
