"""Designs: settings drawn from a space."""

import itertools
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import qtab
from qtab import designs
from support.sweeps import CAR

not_a_mapping: Any = 3
endless: Any = itertools.count()


def test_a_design_can_be_used_as_a_grid():
    space = {"learning_rate": (0.01, 1.0, "log"), "discount": (0.8, 1.0), "episodes": range(3, 9)}
    for design in (designs.random(space, 8, seed=1), designs.sobol(space, 8, seed=1)):
        study = qtab.sweep(CAR, design, seeds=2)
        assert len(study) == 16
        assert study.columns["learning_rate"][::2].tolist() == [setting["learning_rate"] for setting in design]


def test_sobol_points_are_spread_evenly():
    points = designs.sobol({"a": (0.0, 8.0), "b": ["x", "y"]}, 8, seed=3)
    assert sorted(int(point["a"]) for point in points) == list(range(8))
    assert sorted(point["b"] for point in points) == ["x"] * 4 + ["y"] * 4
    assert designs.sobol({"a": (0.0, 8.0)}, 8, seed=3) == designs.sobol({"a": (0.0, 8.0)}, 8, seed=3)
    with pytest.raises(ValueError, match="power of two"):
        designs.sobol({"a": (0.0, 8.0)}, 7)


@settings(max_examples=settings().max_examples, deadline=None)
@given(low=st.floats(1e-6, 1.0), span=st.floats(0.01, 100), seed=st.integers(0, 2**32))
def test_points_lie_within_their_space(low, span, seed):
    space = {"a": (low, low + span), "b": (low, low + span, "log"), "c": [1, 2, 3]}
    for point in designs.random(space, 5, seed=seed):
        assert low <= point["a"] <= low + span
        assert low * (1 - 1e-12) <= point["b"] <= (low + span) * (1 + 1e-12)
        assert point["c"] in (1, 2, 3)


@pytest.mark.parametrize("axis", [(2, 1), (0, 1, "log"), (1, 2, "lin"), 3, [], "ab", (1,)])
def test_a_bad_axis_is_refused_by_name(axis):
    with pytest.raises((ValueError, TypeError), match=r"space\['a'\] must"):
        designs.random({"a": axis}, 3)


@pytest.mark.parametrize("axis", [(-1.7e308, 1.7e308), (1e-300, 1e300, "log")])
@pytest.mark.parametrize("design", [designs.random, designs.sobol])
def test_bounds_too_far_apart_for_a_float_are_refused(design, axis):
    with pytest.raises(ValueError, match=r"space\['a'\] must have bounds whose \w+ is less than 1.8e308, got"):
        design({"a": axis}, 4)


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: designs.random(not_a_mapping, 4), TypeError, "space must map at least one name .* got 3"),
        (lambda: designs.sobol(not_a_mapping, 4), TypeError, "space must map at least one name .* got 3"),
        (lambda: designs.sobol({}, 4), ValueError, "space must map at least one name .* got {}"),
        (lambda: designs.random({"a": (0, 1)}, 10**12), ValueError, "points must be an integer from 1 to 1000000"),
        (lambda: designs.grid(not_a_mapping), TypeError, "grid must map names of settings to lists of values, got 3"),
        (lambda: designs.grid({str(n): range(10) for n in range(12)}), ValueError, "grid must have at most 1,000,000"),
        (lambda: designs.grid({"a": endless}), ValueError, "grid must have at most 1,000,000"),
    ],
)
def test_bad_designs_are_refused_by_name(call, error, message):
    with pytest.raises(error, match=message):
        call()
