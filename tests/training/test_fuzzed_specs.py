"""Whatever a specification holds, the extension trains or raises one of its documented errors: it never panics."""

from typing import Any

import numpy as np
from gymnasium.spaces import Box, Dict, Discrete
from hypothesis import given
from hypothesis import strategies as st

from qtab import _core
from qtab.training.setup.resolve import resolve
from support.environments import Sampled
from support.wild import NUMBERS, SCALARS, VALUES, limited_memory, paths_of, replaced

DOCUMENTED = (TypeError, ValueError, OverflowError, MemoryError)
TILES: dict[str, Any] = {"discretizer": "tiles", "tilings": 3, "tiles": 4, "learning_rate": 0.1}


def spec_of(env, settings):
    """A specification, with those settings alone that are given."""
    spec = resolve(env, {"episodes": 3, "max_episode_steps": 30, **settings}).spec()
    return {**spec, "settings": {name: value for name, value in spec["settings"].items() if value is not None}}


SPECS: list[Any] = [
    spec_of(env, settings)
    for env, settings in [
        ("MountainCar-v0", {}),
        ("MountainCar-v0", {"algorithm": "double_q_learning", "initial_q": np.zeros((19, 15, 3))}),
        ("MountainCar-v0", {"algorithm": "sarsa_lambda", **TILES}),
        ("MountainCar-v0", {"algorithm": "true_online_sarsa_lambda", "hashed_rows": 64, **TILES}),
        ("CartPole-v1", {"discretizer": "bins", "bins": 3, "algorithm": "n_step_sarsa", "n_steps": 3}),
        ("CliffWalking-v1", {"algorithm": "dyna_q_plus", "planning_steps": 3}),
        ("CliffWalking-v1", {"algorithm": "dyna_q", "planning_steps": 3, "model": "stochastic"}),
        ("CliffWalking-v1", {"algorithm": "prioritized_sweeping", "planning_steps": 3}),
        ("FrozenLake-v1", {"algorithm": "off_policy_monte_carlo", "count_bonus": 0.5}),
        ("MountainCar-v0", {"algorithm": "n_step_q_sigma", "n_steps": 3, **TILES}),
        ("MountainCar-v0", {"algorithm": "differential_sarsa", **TILES}),
        ("Taxi-v4", {"exploration": "softmax", "temperature": 1.0}),
        ("Blackjack-v1", {"learning_rate_schedule": "visits", "learning_rate": 1.0}),
    ]
] + [
    spec_of(Sampled(Dict(room=Discrete(3), speed=Box(-1.0, 1.0, (2,)), heat=Box(-1.0, 1.0, ()))), settings)
    for settings in ({"scale": (3, 4, 2)}, {"learning_rate": 0.1, "discretizer": {"speed": "tiles", "heat": "bins"}})
]
MOST_STEPS = 1000
"""Longer episodes, and longer planning, are only prepared."""
MEMORY = 2**26


@st.composite
def changed_specs(draw):
    """A specification in which up to three values are others, and some keys may be missing."""
    spec = draw(st.sampled_from(SPECS))
    for _ in range(draw(st.integers(1, 3))):
        path = draw(st.sampled_from([path for path in paths_of(spec) if path != ("env", "env")]))
        spec = replaced(spec, path, draw(NUMBERS | SCALARS | VALUES | st.sampled_from(SPECS)))
        if not isinstance(spec, dict):
            break
    if isinstance(spec, dict) and draw(st.integers(0, 9)) == 0:
        spec = {key: value for key, value in spec.items() if key != draw(st.sampled_from(sorted(spec)))}
    return spec


def is_short(spec):
    planning_steps = spec["settings"].get("planning_steps") or 0
    steps = [spec["max_episode_steps"], planning_steps, spec["num_actions"]]
    return max(steps) <= MOST_STEPS


@given(changed_specs(), st.integers(0, 2**70), st.integers(0, 2))
def test_a_changed_specification_trains_or_is_refused(spec, seed, record):
    try:
        with limited_memory(MEMORY):
            trainer = _core.Trainer(spec, seed, record)
            if is_short(spec):
                trainer.advance(2)
    except DOCUMENTED:
        pass


@given(
    changed_specs(),
    st.lists(st.floats(-10, 10) | NUMBERS, min_size=1, max_size=4),
    st.sampled_from(["f4", "f8", "i8", "O"]),
)
def test_a_changed_discretizer_finds_rows_of_the_table_or_refuses(spec, observation, dtype):
    try:
        discretizer = _core.Discretizer(spec["discretizer"])
        with np.errstate(all="ignore"):  # NumPy's warnings of numbers that the dtype does not hold
            rows = discretizer.active_rows(np.array(observation, dtype))
    except (*DOCUMENTED, KeyError):
        return
    assert ((rows >= 0) & (rows < discretizer.n_rows)).all()


@given(st.sampled_from(SPECS), st.lists(st.integers(0, 3), min_size=6, max_size=6), VALUES)
def test_arrays_for_results_of_other_shapes_are_refused(spec, sizes, seeds):
    results: Any = {
        "returns": np.zeros((2, 3 + sizes[0] // 3)),
        "lengths": np.zeros((2, 3 + sizes[1] // 3), np.int64),
        "terminated": np.zeros((2 + sizes[2] // 3, 3), bool),
        "tables": np.zeros((2, sizes[3])),
        "finished": np.zeros(2 + sizes[4] // 3, bool),
        "masks": np.zeros((2 + sizes[5] // 3, sizes[5] // 2), bool),
    }
    try:
        failed = _core.train_many(spec, seeds if sizes[0] == 1 else [0, 1], results, 2, False)
    except DOCUMENTED:
        return
    assert all(isinstance(error, ValueError) for _, error in failed)
    assert results["finished"].all() == (not failed)
