"""Hundreds of bad calls: each raises a documented error whose message names the argument and shows the value."""

import re
from collections.abc import Callable, Iterator
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab._utils.shown import LONGEST, shown
from qtab.config.choices import CHOICES
from qtab.config.options import OPTIONS
from support.environments import Walk

HUGE, NAN = 10**5000, float("nan")
RAGGED = [[1.0], [1.0, 2.0]]
RATES: tuple[str, ...] = (
    "learning_rate",
    "discount",
    "epsilon",
    "min_epsilon",
    "epsilon_decay",
    "learning_rate_decay",
    "trace_decay",
)
RATES += ("trace_cutoff", "min_learning_rate", "temperature", "time_weight", "value_learning_rate", "confidence")
RATES += ("sigma", "priority_threshold", "reward_learning_rate", "count_bonus")
COUNTS: tuple[str, ...] = (
    "episodes",
    "max_episode_steps",
    "n_steps",
    "planning_steps",
    "learning_rate_warm_up",
    "epsilon_warm_up",
)
COUNTS += ("tilings", "hashed_rows", "max_rows", "order")
LISTS = (
    *("shape", "scale", "tiles", "bins", "low", "high", "edges", "actions", "initial_q"),
    *("centers", "width", "radius"),
)
NOT_REAL: list[Any] = ["x", b"1", NAN, -0.5, 1j, [0.5], {}, True, np.True_, HUGE, -HUGE]
NOT_COUNTS: list[Any] = ["3", 1.5, -1, True, np.True_, [3], NAN, HUGE, np.array([3])]
NOT_CHOICES: list[Any] = ["nope", "", 3, b"auto", ["auto"]]
NOT_LISTS: list[Any] = ["abc", b"1", {"a": object}, 1j, [NAN], [object], ["1", "2"], [[{}]]]


def settings() -> Iterator[tuple[str, Any]]:
    """Every setting with values that none accepts."""
    for name in RATES:
        yield from ((name, value) for value in NOT_REAL)
    for name in COUNTS:
        yield from ((name, value) for value in NOT_COUNTS)
    for name in CHOICES:
        yield from ((name, value) for value in NOT_CHOICES)
    for name in LISTS:
        yield from ((name, value) for value in NOT_LISTS)
    yield from (("seed", value) for value in ["3", 1.5, -1, True, np.True_, [3], NAN])
    for name in ("baseline", "coupled", "scale_step_sizes", "normalized"):
        yield from ((name, value) for value in ["yes", 1, 0, 0.5, [True]])
    yield from (("preset", value) for value in [3, b"solved", "slved", ["solved"]])
    yield from (("env_kwargs", value) for value in [3, "goal_velocity", [("a", 1)], {1: 2}])
    yield from [("actions", RAGGED), ("edges", [[2, 1]]), ("hashed_rows", -HUGE)]
    yield from [("shape", HUGE), ("tiles", HUGE), ("bins", HUGE)]
    yield from (("time_aware", value) for value in [1, 0.5, "yes", None, [True]])
    yield from (("action_mask", value) for value in ["info", 1, 0.5, [True], np.ones(3, np.int8), {}])
    yield from [("initial_q", RAGGED), ("initial_q", np.array([1j])), ("initial_q", np.array(["a"]))]


CAR = "MountainCar-v0"
P = [[[(1.0, 0, 0.0, True)]]]
CALLS: dict[str, tuple[Callable[..., Any], dict[str, Any]]] = {
    "train": (qtab.train, {"env": CAR, "episodes": 1}),
    "train_many": (qtab.train_many, {"env": CAR, "episodes": 1, "seeds": 1}),
    "evaluate": (qtab.evaluate, {"run": "run"}),
    "verify": (qtab.verify, {"run": "run"}),
    "optimum": (qtab.optimum, {"env": "CliffWalking-v1"}),
    "gap": (lambda **given: qtab.optimum("CliffWalking-v1").gap(**given), {}),
    "presets": (qtab.presets, {}),
    "TabularEnv": (qtab.TabularEnv, {"P": P, "initial_state_distrib": [1.0]}),
    "make_vec": (lambda **given: gym.make_vec(f"qtab/{CAR}", **given), {"num_envs": 2}),
}
ARGUMENTS: dict[tuple[str, str], list[Any]] = {
    ("train", "env"): [3, b"MountainCar-v0", ["MountainCar-v0"], gym.Env, 1.5],
    ("train", "config"): [3, "run.npz", [("episodes", 3)]],
    ("train", "callback"): [3, "print"],
    ("train", "callback_every"): [0, -1, 1.5, "3", True, HUGE * -1],
    ("train", "record"): [-1, 1.5, "3", True, HUGE],
    ("train", "progress"): ["no", 1, 0, "yes"],
    ("train_many", "env"): [3, b"MountainCar-v0", 1.5],
    ("train_many", "seeds"): [0, -1, 1.5, "3", None, [], [1, 1], [-1], [1.5], True, {"a": 1}],
    ("train_many", "threads"): [0, -1, 1.5, "2", True, HUGE, 10**6],
    ("train_many", "tables"): ["no", "yes", 0, 1, None, [], 0.0],
    ("train_many", "memory_limit"): [0, -1, 1.5, "1 GB", True],
    ("evaluate", "run"): ["run.npz", 3, CAR, None],
    ("evaluate", "episodes"): [0, -1, 1.5, "3", True, np.True_, HUGE],
    ("evaluate", "seed"): [-1, 1.5, "3", True],
    ("evaluate", "env"): [3, gym.Env, ["MountainCar-v0"]],
    ("evaluate", "env_kwargs"): [3, "goal_velocity", {1: 2}],
    ("evaluate", "max_episode_steps"): [0, -1, 1.5, "3", True],
    ("verify", "run"): ["run.npz", 3, CAR, None],
    ("verify", "episodes"): [0, -1, 1.5, "3", True, 10**6],
    ("verify", "env"): [3, gym.Env, ["MountainCar-v0"]],
    ("verify", "progress"): [3, "print", True],
    ("optimum", "env"): [3, b"Taxi-v4", ["Taxi-v4"], None, 1.5],
    ("optimum", "discount"): [-0.1, 1.1, "x", NAN, 1j, HUGE, True],
    ("optimum", "max_episode_steps"): [0, -1, 1.5, "3", True, HUGE],
    ("optimum", "method"): ["nope", 3, b"search", ["search"]],
    ("optimum", "env_kwargs"): [3, "is_slippery", [("a", 1)]],
    ("gap", "run"): ["run.npz", 3, None],
    ("presets", "env"): [3, None, b"Taxi-v4", "MountanCar-v0", "", "NoSuchThing-v0"],
    ("TabularEnv", "initial_state_distrib"): ["x", [0.5], [[1.0]], None],
    ("make_vec", "copy"): ["no", "yes", 0, 1, None],
    ("make_vec", "threads"): [0, -1, 1.5, "2", True],
}
BAD = [("train", name, value) for name, value in settings()]
BAD += [(function, name, value) for (function, name), values in ARGUMENTS.items() for value in values]


@pytest.fixture(scope="module")
def run() -> qtab.Run:
    return qtab.train(CAR, seed=0, episodes=3)


def test_there_are_hundreds() -> None:
    assert len(BAD) > 400
    assert {name for name, _ in settings()} == qtab.Config.__dataclass_fields__.keys() - {"env"}
    assert OPTIONS.keys() < {name for name, _ in settings()}


@pytest.mark.parametrize(
    ("function", "name", "value"), BAD, ids=[f"{call}-{name}-{shown(value)[:25]}" for call, name, value in BAD]
)
def test_a_bad_call_is_refused_with_the_argument_and_the_value(
    run: qtab.Run, function: str, name: str, value: Any
) -> None:
    call, others = CALLS[function]
    given = {key: run if other == "run" else other for key, other in others.items()}
    with pytest.raises((TypeError, ValueError, OSError, MemoryError)) as caught:
        call(**given | {name: value})
    message = str(caught.value)
    assert re.match(rf"{name}\b", message), message
    parts = [shown(part) for part in value] if isinstance(value, list | tuple) else []
    assert any(text in message for text in (shown(value), *parts)) or isinstance(value, np.ndarray | list)
    assert "\n" not in message
    assert len(message) < LONGEST + 700
    assert caught.type in (TypeError, ValueError, OSError, MemoryError)


Q: Any = qtab  # for a type checker, the calls are errors as well
UNKNOWN: list[tuple[Callable[[], Any], str]] = [
    (lambda: Q.Config(alpha=0.1), "unknown setting 'alpha' (did you mean 'learning_rate'?)"),
    (lambda: Q.Config(wheels=4), "unknown setting 'wheels'; help(qtab.Config) lists the settings"),
    (lambda: Q.train(CAR, alpha=0.1), "unknown setting 'alpha' (did you mean 'learning_rate'?)"),
    (lambda: Q.train(CAR, wheels=4), "unknown setting 'wheels'; help(qtab.train) and qtab train --help list the"),
    (lambda: Q.train_many(CAR, wheels=4), "unknown setting 'wheels'; help(qtab.train_many) lists the settings"),
    (lambda: Q.train_many(CAR, n_jobs=4), "unknown setting 'n_jobs' (did you mean 'threads'?)"),
    (lambda: Q.optimum("Taxi-v4", gamma=0.9), "unknown argument 'gamma' (did you mean 'discount'?)"),
    (lambda: Q.optimum("Taxi-v4", wheels=4), "unknown argument 'wheels'; help(qtab.optimum) lists the arguments"),
    (lambda: Q.evaluate(None, n_episodes=4), "unknown argument 'n_episodes' (did you mean 'episodes'?)"),
    (lambda: Q.verify(None, wheels=4), "unknown argument 'wheels'; help(qtab.verify) lists the arguments"),
]


@pytest.mark.parametrize(("call", "message"), UNKNOWN, ids=[message for _, message in UNKNOWN])
def test_an_unknown_name_is_answered_with_the_nearest_or_with_the_help_of_its_function(call: Any, message: str) -> None:
    with pytest.raises(TypeError, match=re.escape(message)):
        call()


def test_a_misspelled_id_has_no_presets_but_a_suggestion() -> None:
    with pytest.raises(ValueError, match=r"got 'MountanCar-v0' \(did you mean 'MountainCar-v0'\?\)$"):
        qtab.presets("MountanCar-v0")
    assert dict(qtab.presets("BipedalWalker-v3")) == {}
    assert list(qtab.presets("qtab/Taxi-v4")) == ["tuned", "solved"]


SPACES: list[tuple[gym.Space[Any], str]] = [
    (gym.spaces.Dict({"a": gym.spaces.Discrete(2)}), "discretizer must be left out for"),
    (gym.spaces.MultiBinary(3), "discretizer must be left out for"),
    (gym.spaces.Discrete(3), "observation space must be a Box .*discretizer must be left out for it"),
    (gym.spaces.Text(3), "TransformObservation converts it to numbers with a function, or give a function as"),
    (gym.spaces.Dict({"a": gym.spaces.Discrete(2), "b": gym.spaces.Text(3)}), r"FilterObservation\(env, \['a'\]\)"),
    (gym.spaces.Box(0, 1, (2,), np.longdouble), r"DtypeObservation\(env, numpy.float64\) converts it"),
]


@pytest.mark.parametrize(("space", "remedy"), SPACES, ids=[str(space) for space, _ in SPACES])
def test_a_space_that_does_not_fit_is_refused_with_the_wrapper_that_helps(space: Any, remedy: str) -> None:
    env = Walk()
    env.observation_space = space
    with pytest.raises(ValueError, match=remedy):
        qtab.train(env, discretizer="bins", episodes=1)


def test_dyna_q_on_tiles_says_what_it_works_with() -> None:
    with pytest.raises(ValueError, match=r"which works with discretizer 'round', 'bins', 'edges' or 'identity'$"):
        qtab.train(CAR, algorithm="dyna_q", discretizer="tiles")


def test_a_value_is_shown_shortly() -> None:
    assert shown("a" * 10_000).startswith("'aaa")
    assert len(shown("a" * 10_000)) < LONGEST + 10
    assert shown(np.zeros((16, 4))) == "an array of shape (16, 4) and dtype float64"
    assert shown(np.array([0.1, 0.2])) == "array([0.1, 0.2])"
    assert shown(HUGE) == "<int of 16,610 bits>"
    assert shown([1, "b"]) == "[1, 'b']"


def test_keyword_arguments_that_a_constructor_cannot_use_are_named_with_the_environment() -> None:
    lake = "FrozenLake-v1"
    message = f"env_kwargs must be keyword arguments that {lake} accepts, got {{'map_name': '9x9'}}: KeyError('9x9')"
    run = Q.train(lake, seed=0, episodes=1)
    for call in (Q.train, Q.optimum, lambda env, **given: Q.evaluate(run, env=env, **given)):
        with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
            call(lake, env_kwargs={"map_name": "9x9"})


def test_an_error_of_a_constructor_without_keyword_arguments_is_raised_unchanged() -> None:
    def make(**_: Any) -> gym.Env:
        raise KeyError("door")

    gym.register("NoDoor-v0", make)
    with pytest.raises(KeyError, match="door"):
        qtab.train("NoDoor-v0")
    del gym.registry["NoDoor-v0"]
