"""An environment as gymnasium.make returns it trains in Rust; any other is stepped in Python, which is said once."""

import functools
import logging
import re
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.wrappers import RecordEpisodeStatistics, TimeLimit, TransformObservation

import qtab
from qtab.envs.registry import ENTRIES, EXTRA
from qtab.training.setup import resolved_run
from qtab.training.train_many import resolve_template
from support.environments import Walk
from support.parity import assert_same_run

RUST: dict[str, Any] = {"seed": 5, "episodes": 12, "max_episode_steps": 60}
BINS: dict[str, Any] = {"discretizer": "bins", "bins": 4}
BOXES: dict[str, dict[str, Any]] = {
    "MountainCar-v0": {},
    "MountainCarContinuous-v0": {**BINS, "actions": 3},
    "CartPole-v0": {**BINS, "low": (-2, -2, -0.2, -2), "high": (2, 2, 0.2, 2)},
    "CartPole-v1": {**BINS, "low": (-2, -2, -0.2, -2), "high": (2, 2, 0.2, 2)},
    "Acrobot-v1": {**BINS, "bins": 3},
    "Pendulum-v1": {**BINS, "actions": 3},
}
KWARGS: dict[str, list[dict[str, Any]]] = {
    "MountainCar-v0": [{"goal_velocity": 0.02}],
    "MountainCarContinuous-v0": [{"goal_velocity": 0.02}],
    "CartPole-v1": [{"sutton_barto_reward": True}],
    "Pendulum-v1": [{"g": 9.81}],
    "FrozenLake-v1": [{"is_slippery": False}, {"map_name": "8x8"}, {"desc": ["SFF", "FHF", "FFG"]}],
    "CliffWalking-v1": [{"is_slippery": True}],
    "Taxi-v4": [{"is_rainy": True}, {"fickle_passenger": True}],
    "Blackjack-v1": [{"natural": True}, {"sab": True}],
}
SMALLER: dict[str, dict[str, Any]] = {"qtab/JacksCarRental-v0": {"cars": 4}}
"""Arguments that spare an environment most of its millions of transitions, which take a second."""
VARIANTS: list[dict[str, Any]] = [{}, {"max_episode_steps": 17}, {"disable_env_checker": True}]
MADE = [
    (env, {**SMALLER.get(env, {}), **kwargs})
    for name in [*ENTRIES, *EXTRA]
    for env in dict.fromkeys([name, f"qtab/{name.removeprefix('qtab/')}"])
    if env in gym.registry
    for kwargs in [*VARIANTS, *KWARGS.get(name, [])]
]


def settings_of(env: str) -> dict[str, Any]:
    chosen = BOXES.get(env.removeprefix("qtab/"), {})
    return RUST | chosen | ({"scale": ()} if "discretizer" in chosen else {})


@pytest.mark.filterwarnings("ignore:.*is out of date:DeprecationWarning")
@pytest.mark.parametrize(("env", "kwargs"), MADE, ids=str)
def test_an_untouched_environment_trains_in_rust_with_the_bits_of_python(env, kwargs):
    made = gym.make(env, **kwargs)
    run = qtab.train(made, **settings_of(env))
    assert run.config.backend == "rust"
    slow = qtab.train(gym.make(env, **kwargs), backend="gymnasium", **settings_of(env))
    assert_same_run(run, slow)
    assert run.config.max_episode_steps == kwargs.get("max_episode_steps", 60) == slow.config.max_episode_steps
    made.close()


def used(env: gym.Env) -> gym.Env:
    """An environment whose generator, state and step count are somewhere in an episode."""
    env.reset(seed=99)
    env.action_space.seed(99)
    for _ in range(7):
        env.step(env.action_space.sample())
    env.unwrapped.np_random = np.random.Generator(np.random.MT19937(3))
    return env


@pytest.mark.parametrize("env", ["MountainCar-v0", "CartPole-v1", "Taxi-v4", "Blackjack-v1", "qtab/Acrobot-v1"])
def test_the_state_of_an_environment_does_not_matter(env):
    run = qtab.train(used(gym.make(env)), **settings_of(env))
    assert run.config.backend == "rust"
    assert_same_run(run, qtab.train(used(gym.make(env)), backend="gymnasium", **settings_of(env)))
    assert_same_run(run, qtab.train(env, **settings_of(env)))


@pytest.mark.parametrize("limits", [(30, None), (30, 20), (30, 50), (None, 50), (None, None)])
def test_the_lower_of_two_time_limits_ends_an_episode(limits):
    wrapped, asked = limits

    def train(backend):
        env = gym.make("MountainCar-v0")
        env = env if wrapped is None else TimeLimit(env, wrapped)
        return qtab.train(env, seed=1, episodes=4, max_episode_steps=asked, backend=backend)

    run, slow = train("auto"), train("gymnasium")
    assert run.config.backend == "rust"
    assert_same_run(run, slow)
    assert run.config.max_episode_steps == slow.config.max_episode_steps == run.episode_lengths[0]
    assert qtab.verify(run).equal


def replaced_step(env: Any) -> gym.Env:
    env.unwrapped.step = functools.partial(env.unwrapped.step)
    return env


def replaced_reset(env: Any) -> gym.Env:
    env.reset = functools.partial(env.reset)
    return env


def edited(env: Any, name: str, value: Any) -> gym.Env:
    setattr(env.unwrapped, name, value)
    return env


def narrowed(env: Any) -> gym.Env:
    env.action_space = gym.spaces.Discrete(2)
    return env


TOUCHED: dict[str, tuple[Any, str]] = {
    "an edited attribute": (
        lambda: edited(gym.make("MountainCar-v0"), "gravity", 0.002),
        "MountainCar-v0 is stepped in Python, which is much slower than Rust: its attribute gravity was changed from "
        "0.0025 to 0.002; pass the environment as gymnasium.make returns it",
    ),
    "a replaced step": (lambda: replaced_step(gym.make("MountainCar-v0")), "its method step was replaced"),
    "a replaced reset": (lambda: replaced_reset(gym.make("MountainCar-v0")), "its method reset was replaced"),
    "a replaced step of a table": (lambda: replaced_step(gym.make("FrozenLake-v1")), "its method step was replaced"),
    "fewer actions": (
        lambda: narrowed(gym.make("MountainCar-v0")),
        r"its action_space was changed from Discrete\(3\) to Discrete\(2\)",
    ),
    "fewer actions inside": (
        lambda: edited(gym.make("MountainCar-v0"), "action_space", gym.spaces.Discrete(2)),
        r"its action_space was changed from Discrete\(3\) to Discrete\(2\)",
    ),
    "a wrapper": (
        lambda: RecordEpisodeStatistics(gym.make("MountainCar-v0")),
        "Rust does not implement its wrapper RecordEpisodeStatistics; pass the environment without this wrapper",
    ),
    "features as observations": (
        lambda: TransformObservation(gym.make("MountainCar-v0"), lambda one: one, None),
        "TransformObservation; compute its observations in the environment itself, such as a qtab.FunctionalEnv",
    ),
    "a render mode": (
        lambda: gym.make("MountainCar-v0", render_mode="rgb_array"),
        "its render_mode is 'rgb_array'; without a render mode Rust steps it",
    ),
    "no id": (
        lambda: TimeLimit(gym.make("MountainCar-v0").unwrapped.__class__(), 200),
        "Rust does not implement MountainCarEnv without an id of Gymnasium's; pass the environment that gymnasium.make",
    ),
    "a class of the user's": (
        lambda: TimeLimit(Walk(), 30),
        "Rust does not implement Walk; an environment whose transition table is known can be a qtab.TabularEnv",
    ),
}


@pytest.fixture
def logged(caplog, monkeypatch):
    """The messages of the logger ``qtab``, as in a process that has logged nothing yet."""
    monkeypatch.setattr(resolved_run, "_logged", set())
    caplog.set_level(logging.DEBUG, logger="qtab")
    return caplog


@pytest.mark.parametrize(("make", "message"), TOUCHED.values(), ids=TOUCHED)
def test_any_other_environment_is_stepped_in_python_and_says_why_once(logged, make, message):
    chosen: dict[str, Any] = {"seed": 0, "episodes": 2, "max_episode_steps": 20}
    chosen |= {} if make().spec is not None else {"scale": (2.0, 2.0)}
    for _ in range(2):
        run = qtab.train(make(), **chosen)
    assert run.config.backend == "gymnasium"
    (said,) = logged.messages
    assert re.search(message, said), said


def test_nothing_is_said_where_python_was_asked_for_or_without_progress(logged):
    chosen: dict[str, Any] = {"scale": (2.0, 2.0), "episodes": 2, "max_episode_steps": 20}
    qtab.train(TimeLimit(Walk(), 30), backend="gymnasium", **chosen)
    qtab.train(TimeLimit(Walk(), 30), progress=False, **chosen)
    qtab.train(gym.make("MountainCar-v0"), episodes=2)
    assert logged.messages == []
    logging.getLogger("qtab").setLevel(logging.ERROR)
    qtab.train(TimeLimit(Walk(), 30), **chosen)
    assert logged.messages == []


def test_an_evaluation_in_an_untouched_environment_runs_in_rust(logged, monkeypatch):
    run = qtab.train("MountainCar-v0", seed=0, episodes=50)
    stepped = gym.make("MountainCar-v0")
    wrapped: gym.Env = RecordEpisodeStatistics(gym.make("MountainCar-v0"))
    slow = qtab.evaluate(run, 5, seed=2, env=wrapped)
    assert "its wrapper RecordEpisodeStatistics" in logged.messages[0]
    fast = qtab.evaluate(run, 5, seed=2, env=stepped)
    assert stepped.get_wrapper_attr("_elapsed_steps") is None
    assert fast.returns.tobytes() == slow.returns.tobytes()
    assert len(logged.messages) == 1


def test_functions_that_make_equal_environments_train_in_rust():
    runs = qtab.train_many(lambda: gym.make("Taxi-v4", is_rainy=True), seeds=3, episodes=20)
    assert runs.config.backend == "rust"
    for index, seed in enumerate(runs.seeds):
        single = qtab.train(gym.make("Taxi-v4", is_rainy=True), seed=seed, episodes=20, backend="gymnasium")
        assert runs.episode_returns[index].tobytes() == single.episode_returns.tobytes()


MAPS = [["SFG"], ["SHG"], ["SGF"]]


def test_functions_that_make_different_environments_give_each_run_its_own():
    maps = iter(MAPS * 3)
    made = []

    def make() -> gym.Env:
        made.append(next(maps))
        return gym.make("FrozenLake-v1", desc=made[-1], is_slippery=False)

    resolved = resolve_template(make, {"seed": 0})
    assert not resolved.is_native
    with pytest.raises(ValueError, match="env must make equal environments at every call for backend 'rust'"):
        resolve_template(make, {"seed": 0, "backend": "rust"})


def test_keyword_arguments_beside_an_environment_are_refused():
    with pytest.raises(ValueError, match=r"^env_kwargs must be left out with an environment object, got {'is_sl"):
        qtab.train(gym.make("FrozenLake-v1"), env_kwargs={"is_slippery": False})


def test_the_config_of_a_run_beside_an_environment_keeps_the_keyword_arguments_of_the_environment():
    first = qtab.train("FrozenLake-v1", env_kwargs={"is_slippery": False}, seed=0, episodes=5)
    again = qtab.train(gym.make("FrozenLake-v1", is_slippery=False), config=first.config)
    assert again.config.env_kwargs == {"is_slippery": False} | {"map_name": "4x4"}
    assert_same_run(first, again)
