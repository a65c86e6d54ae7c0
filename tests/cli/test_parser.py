"""The words of a command line: how flags and values may be written."""

from pathlib import Path
from typing import Any

import pytest

from qtab.cli.command import parser_of
from qtab.cli.errors import UsageError


@pytest.mark.parametrize(
    ("line", "name", "value"),
    [
        ("--learning-rate 0.5", "learning_rate", 0.5),
        ("--learning_rate=0.5", "learning_rate", 0.5),
        ("--seed None", "seed", None),
        ("--low None", "low", None),
        ("--low -1e-3 -inf -.5", "low", (-0.001, float("-inf"), -0.5)),
        ("--initial-q -2 -1 --seed 3", "initial_q", (-2.0, -1.0)),
        ("--low -Infinity -INF", "low", (float("-inf"), float("-inf"))),
        ("--scale", "scale", ()),
        ("--scale=10 100", "scale", (10.0, 100.0)),
        ("--initial_q=-2 -1", "initial_q", (-2.0, -1.0)),
        ("--time-aware True", "time_aware", True),
        ("--env-kwargs map_name 4x4 is_slippery false", "env_kwargs", {"map_name": "4x4", "is_slippery": False}),
        ("--visits", "visits", True),
        ("--visits --no-visits", "visits", False),
        ("--seed 1 --seed 2", "seed", 2),
        ("--save None", "save", None),
        ("-- Taxi-v4", "env", "Taxi-v4"),
        ("--scale 10 100 -- Taxi-v4", "env", "Taxi-v4"),
        ("-- -name", "env", "-name"),
    ],
)
def test_a_value_is_read_from_its_words(line: str, name: str, value: Any) -> None:
    assert getattr(parser_of("train", line.split()).read(), name) == value


def test_a_setting_that_is_not_given_is_absent() -> None:
    options = parser_of("train", ["--seed", "3"]).read()
    assert "seed" in options
    assert "episodes" not in options


def test_what_follows_two_hyphens_is_no_flag() -> None:
    options = parser_of("record", ["--seed", "3", "--", "-run.npz", "--seed"]).read()
    assert (options.run, options.path, options.seed) == (Path("-run.npz"), Path("--seed"), 3)
    with pytest.raises(UsageError, match="unexpected argument '--json'"):
        parser_of("train", ["--", "Taxi-v4", "--json"]).read()


def test_flags_may_separate_arguments_without_a_flag() -> None:
    options = parser_of("record", ["--fps", "9", "run.npz", "--seed", "3", "agent.gif", "--episodes", "2"]).read()
    assert (options.run, options.path, options.seed) == (Path("run.npz"), Path("agent.gif"), 3)


def test_flags_are_not_abbreviated() -> None:
    assert "episodes" in parser_of("train").flags()
    with pytest.raises(UsageError, match=r"unknown option --episo \(did you mean --episodes\?\)"):
        parser_of("train", ["--episo", "3"]).read()
