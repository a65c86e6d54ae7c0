"""Bounds that the checks in Python and those of the extension must agree on."""

import math

import pytest

import qtab


@pytest.mark.parametrize("value", [-1, 2**32])
def test_the_range_of_seeds_of_mt19937_is_named(value):
    with pytest.raises(ValueError, match=f"seed must be an integer from 0 to {2**32 - 1}, got {value}"):
        qtab.Config(bit_generator="MT19937", seed=value)


def test_the_smallest_temperature_trains():
    smallest = math.ulp(0.0)
    run = qtab.train("FrozenLake-v1", exploration="softmax", temperature=smallest, episodes=2, seed=0)
    assert run.config.temperature == smallest
