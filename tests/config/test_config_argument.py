"""``config=`` starts a call from a config: explicit keywords come first, presets and defaults after it."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.config import presets
from qtab.config.choices import CHOICES
from qtab.config.options import OFF_BY_NONE, OPTIONS
from support.environments import Walk

CAR = "MountainCar-v0"
RUNS: dict[str, tuple[str, dict[str, Any]]] = {
    "the article": (CAR, {}),
    "tile coding and traces": (CAR, {"preset": "solved", "episodes": 5}),
    "options of every kind": (
        "qtab/MountainCar-v0",
        {
            "env_kwargs": {"goal_velocity": 0.01},
            "algorithm": "double_q_learning",
            "exploration": "softmax",
            "discretizer": "edges",
            "edges": ((-0.5,), (0.0,)),
            "learning_rate_schedule": "visits",
            "initial_q": np.zeros((2, 2, 3)),
            "bit_generator": "MT19937",
            "on_truncation": "terminate",
        },
    ),
    "hashed rows": (CAR, {"discretizer": "tiles", "hashed_rows": 100, "scale": ()}),
    "a preset with bins": ("CartPole-v1", {}),
    "an initial table with missing actions": ("qtab/MaximizationBias-v0", {}),
    "continuous actions": ("Pendulum-v1", {"actions": ((-1.0,), (0.5,))}),
    "a discrete environment stepped in Python": ("FrozenLake-v1", {"backend": "gymnasium"}),
}


def fields(config: qtab.Config) -> dict[str, Any]:
    return {name: repr(value) for name, value in vars(config).items()}


@pytest.mark.parametrize(("env", "settings"), RUNS.values(), ids=RUNS)
def test_the_config_of_a_run_repeats_it(env: str, settings: dict[str, Any]) -> None:
    run = qtab.train(env, **{"episodes": 20, **settings})
    again = qtab.train(config=run.config)
    assert fields(again.config) == fields(run.config)
    assert again.tables.tobytes() == run.tables.tobytes()
    assert again.episode_returns.tobytes() == run.episode_returns.tobytes()
    assert fields(qtab.train(env, config=run.config).config) == fields(run.config)


@pytest.mark.filterwarnings("ignore:.*unversioned environment")
def test_an_id_without_its_version_is_the_environment_of_the_config() -> None:
    run = qtab.train("FrozenLake-v1", env_kwargs={"is_slippery": False}, episodes=2)
    assert fields(qtab.train("FrozenLake", config=run.config).config) == fields(run.config)


def test_the_config_of_a_run_on_an_object_repeats_it_on_another() -> None:
    run = qtab.train(Walk(), scale=(1.0, 1.0), episodes=20)
    again = qtab.train(Walk(), config=run.config)
    assert again.tables.tobytes() == run.tables.tobytes()


@pytest.fixture
def hashed_preset(monkeypatch: pytest.MonkeyPatch) -> None:
    """A preset with an option that a run may have or not."""
    tiles = {**qtab.presets(CAR)["solved"], "learning_rate": 0.5, "episodes": 4, "hashed_rows": 512}
    monkeypatch.setitem(presets._PRESETS, CAR, {"hashed": tiles})


@pytest.mark.usefixtures("hashed_preset")
@pytest.mark.parametrize(
    ("settings", "rows"),
    [({}, 512), ({"hashed_rows": 300}, 300), ({"hashed_rows": None}, 2592), ({"discretizer": "bins", "bins": 4}, 16)],
)
def test_what_a_run_has_off_its_preset_does_not_turn_on(settings: dict[str, Any], rows: int) -> None:
    run = qtab.train(CAR, seed=1, **settings)
    for again in (qtab.train(config=run.config), qtab.train(CAR, config=run.config)):
        assert again.tables[0].size == rows * 3
        assert fields(again.config) == fields(run.config)
        assert again.tables.tobytes() == run.tables.tobytes()
    stopped = qtab.train(config=run.config, callback=lambda progress: False, callback_every=2)
    assert qtab.resume(stopped).tables.tobytes() == run.tables.tobytes()


@pytest.mark.usefixtures("hashed_preset")
def test_a_preset_turns_on_what_was_left_open_or_did_not_apply() -> None:
    assert qtab.train(config=qtab.Config(CAR, discretizer="tiles", episodes=1)).config.hashed_rows == 512
    run = qtab.train(CAR, discretizer="bins", bins=4)
    assert qtab.train(config=run.config, discretizer="tiles").config.hashed_rows == 512
    off = qtab.train(CAR, hashed_rows=None)
    assert qtab.train(config=off.config, hashed_rows=300).config.hashed_rows == 300
    assert qtab.train(config=off.config, discretizer="bins", bins=4).config.hashed_rows is None


def test_the_options_that_may_be_off_are_known() -> None:
    """The others without a default are found from the space or must be given, so that no run leaves them None."""
    without_default = {name for name, option in OPTIONS.items() if option.default is None}
    assert without_default == {"scale", "edges", "low", "high", "shape", *OFF_BY_NONE}


def test_keywords_override_the_config_and_the_config_overrides_the_preset() -> None:
    config = qtab.Config(CAR, episodes=7, learning_rate=0.3)
    run = qtab.train(config=config, learning_rate=0.4)
    assert (run.config.learning_rate, run.config.episodes) == (0.4, 7)
    # The preset fills in only what the config does not have.
    assert (run.config.scale, run.config.terminal_update) == ((10.0, 100.0), "target")
    named = qtab.train(config={"env": CAR, "episodes": 7, "discount": 0.95}, preset="solved", tilings=4).config
    assert (named.episodes, named.discount, named.tilings, named.algorithm) == (7, 0.95, 4, "true_online_sarsa_lambda")


def test_a_keyword_drops_conflicting_options_of_a_config_but_not_of_a_mapping() -> None:
    run = qtab.train(CAR, preset="solved", episodes=3)
    other = qtab.train(config=run.config, algorithm="q_learning")
    assert (other.config.algorithm, other.config.trace_decay, other.config.tilings) == ("q_learning", None, 32)
    with pytest.raises(ValueError, match=r"^trace_decay applies to algorithm .*, not to 'q_learning', got 0.5$"):
        qtab.train(CAR, config={"algorithm": "sarsa_lambda", "trace_decay": 0.5}, algorithm="q_learning")


@pytest.mark.parametrize(
    "settings",
    [
        {},
        {"exploration": "ucb"},
        {"exploration": "softmax"},
        {"algorithm": "dyna_q_plus"},
        {
            "learning_rate": 0.5,
            "learning_rate_schedule": "exponential",
            "epsilon": 0.5,
            "epsilon_schedule": "exponential",
        },
    ],
    ids=str,
)
def test_a_choice_of_a_config_that_another_replaces_takes_its_options_along(settings: dict[str, Any]) -> None:
    short: dict[str, Any] = {"episodes": 1, "max_episode_steps": 2}
    config = qtab.train(CAR, discretizer="bins", bins=2, **short, **settings).config
    others = [
        ("discretizer", "tiles"),
        *((name, word) for name in ("algorithm", "exploration") for word in CHOICES[name]),
    ]
    for name, word in others:
        change: dict[str, Any] = {name: word}
        assert getattr(qtab.train(config=config, **change).config, name) == word


def test_a_replaced_environment_has_its_own_presets() -> None:
    lake = qtab.train("FrozenLake-v1", preset="time_aware", episodes=1, env_kwargs={"is_slippery": False}).config
    assert lake.replace(env="FrozenLake8x8-v1").env_kwargs == {"is_slippery": False}
    run = qtab.train("FrozenLake-v1", preset="solved", episodes=1)
    assert run.config.env_kwargs == {"map_name": "4x4"}  # as the id is registered
    config = run.config.replace(env="CliffWalking-v1")
    assert (config.preset, config.env_kwargs, config.max_episode_steps, config.episodes) == (None, {}, None, 1)
    assert qtab.train(config=config, max_episode_steps=5).config.env == "CliffWalking-v1"


def test_another_environment_ignores_the_configs_environment_specific_settings() -> None:
    run = qtab.train(CAR, env_kwargs={"goal_velocity": 0.01}, episodes=3, seed=5)
    other = qtab.train("CartPole-v1", config=run.config, backend="auto", discretizer="bins", bins=3, scale=())
    assert (other.config.env_kwargs, other.config.preset, other.config.seed) == ({}, "tuned", 5)


def test_an_environment_spec_takes_its_own_config() -> None:
    run = qtab.train(CAR, env_kwargs={"goal_velocity": 0.01}, episodes=3)
    assert fields(qtab.train(gym.spec(CAR), config=run.config).config) == fields(run.config)


def test_many_runs_start_from_the_config_of_one() -> None:
    run = qtab.train(CAR, preset="solved", episodes=4, seed=3)
    runs = qtab.train_many(seeds=[3, 4], config=run.config, tables=True)
    assert runs.tables is not None
    assert runs.tables[0].tobytes() == run.tables.tobytes()
    assert fields(runs.config) == fields(run.config)
    assert fields(qtab.train(config=runs.config).config) == fields(run.config)


def test_a_sweep_starts_from_the_config_of_a_run() -> None:
    run = qtab.train(CAR, preset="solved", episodes=4, seed=0)
    swept = qtab.sweep(None, {"algorithm": ["true_online_sarsa_lambda", "q_learning"]}, 2, config=run.config)
    assert len(swept) == 4
    assert swept.failed == 0
    assert swept.columns["mean_return"][0] == run.episode_returns.mean()


@pytest.mark.parametrize(
    ("config", "error", "message"),
    [
        (3, TypeError, "^config must be a qtab.Config or a mapping of settings, got 3$"),
        ({"learnig_rate": 0.1}, TypeError, r"^unknown setting 'learnig_rate' \(did you mean 'learning_rate'\?\)$"),
        ({"callback": print}, TypeError, "^unknown setting 'callback'"),
        ({"env": CAR, "learning_rate": "fast"}, TypeError, "^learning_rate must be a finite number, got 'fast'$"),
        ({"env": 3}, TypeError, "^env must be an environment id, an EnvSpec or an environment, got 3$"),
        ({}, TypeError, "^env must be an environment id, an EnvSpec or an environment, got None$"),
    ],
)
def test_a_bad_config_is_refused(config: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        qtab.train(config=config)


def test_the_seed_of_a_mapping_is_not_for_many_runs() -> None:
    with pytest.raises(TypeError, match=r"^unknown setting 'seed'"):
        qtab.train_many(CAR, config={"seed": 3})


def test_rates_and_initial_weights_do_not_outlive_the_features_that_they_were_for() -> None:
    tiles = qtab.train("CartPole-v1", preset="solved", episodes=1, seed=0).config
    waves = qtab.train("CartPole-v1", preset="solved", episodes=1, seed=0, discretizer="fourier", order=1).config
    assert tiles.learning_rate != waves.learning_rate == 0.001
    replaced = tiles.replace(discretizer="fourier", tilings=None, tiles=None)
    for one in (qtab.train(config=tiles, discretizer="fourier", order=1).config, replaced):
        assert (one.learning_rate, one.learning_rate_schedule, one.initial_q) == (0.001, "constant", 0.0)
    assert qtab.train(config=waves, discretizer="tiles").config.learning_rate == tiles.learning_rate
    assert qtab.train(config=tiles, discretizer="fourier", order=1, learning_rate=0.002).config.learning_rate == 0.002
    swept = qtab.sweep("CartPole-v1", {"discretizer": ["tiles", "fourier"]}, config=tiles, seeds=1)
    assert [one["learning_rate"] for one in swept.configs] == [tiles.learning_rate, 0.001]


def test_the_rates_of_both_tables_follow_features_that_sum_to_one() -> None:
    config = qtab.Config("MountainCar-v0", discretizer="radial", algorithm="actor_critic", episodes=1)
    assert config.learning_rate == 0.001
    run = qtab.train(config=config, normalized=True)
    assert (run.config.learning_rate, run.config.value_learning_rate) == (0.1, 0.1)
    again = qtab.train(config=run.config, normalized=False)
    assert (again.config.learning_rate, again.config.value_learning_rate) == (0.001, 0.005)
    assert qtab.train(config=run.config.replace(initial_q=-20.0), normalized=False).config.initial_q == 0.0
    assert qtab.train(config=run.config, centers=4).config.learning_rate == 0.1


def test_the_options_of_a_schedule_keep_it_when_the_discretizer_changes() -> None:
    falls = qtab.Config("MountainCar-v0", discretizer="bins", learning_rate=0.2, min_learning_rate=0.01, episodes=1)
    waves = falls.replace(discretizer="fourier", bins=None, min_learning_rate=1e-5)
    assert (waves.learning_rate, waves.learning_rate_schedule, waves.min_learning_rate) == (0.001, "linear", 1e-5)
    wrong: Any = np.array([True, False])
    with pytest.raises(TypeError, match=r"^normalized must be True or False"):
        waves.replace(discretizer="radial", order=None, normalized=wrong)
