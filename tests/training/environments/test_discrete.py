"""Training on discrete observations: toy text in Rust, other environments in Python."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.spaces import Box, Discrete, MultiDiscrete, Tuple

import qtab
from qtab.config.options import PREFERENCES, n_tables
from qtab.reference import LEARNERS
from support.lockstep.toy_text import IDS
from support.parity import assert_same_run

SETTINGS: dict[str, Any] = {"episodes": 150, "seed": 5, "epsilon": 0.5, "learning_rate": 0.3, "initial_q": (-1.0, 1.0)}


def same_everywhere(env: str, **settings: Any) -> qtab.Run:
    """Asserts that Rust, Gymnasium with the learner in Rust, and NumPy agree."""
    settings = {**SETTINGS, **settings}
    if settings.get("algorithm") in PREFERENCES:
        del settings["epsilon"]
    rust = qtab.train(env, backend="rust", **settings)
    assert rust.config.backend == "rust"
    assert_same_run(rust, qtab.train(env, backend="gymnasium", **settings))
    assert qtab.verify(rust).equal
    return rust


@pytest.mark.parametrize("name", IDS)
@pytest.mark.parametrize("bit_generator", ["PCG64", "MT19937"])
def test_rust_trains_as_gymnasium_and_numpy_do(name, bit_generator):
    limit: dict[str, Any] = {"max_episode_steps": 200} if "Cliff" in name else {}  # else 10,000
    run = same_everywhere(name, bit_generator=bit_generator, episodes=10, **limit)
    assert run.config.discretizer == "identity"
    assert run.episode_lengths.sum() > 10


@pytest.mark.parametrize("algorithm", LEARNERS)
@pytest.mark.parametrize("name", ["FrozenLake-v1", "Taxi-v4", "Blackjack-v1"])
def test_every_algorithm_learns_the_same(name, algorithm):
    run = same_everywhere(name, algorithm=algorithm, episodes=5, max_episode_steps=40)
    assert len(run.tables) == n_tables(algorithm)


@pytest.mark.parametrize(
    ("name", "env_kwargs"),
    [
        ("FrozenLake-v1", {"is_slippery": False}),
        ("FrozenLake-v1", {"desc": ["SFFH", "FHFS", "FFFG"], "success_rate": 0.8, "reward_schedule": (10, -5, -1)}),
        ("FrozenLake-v1", {"map_name": "8x8", "render_mode": None}),
        ("FrozenLake8x8-v1", {"map_name": "4x4"}),
        ("CliffWalking-v1", {"is_slippery": True}),
        ("Blackjack-v1", {"natural": True, "sab": False}),
        ("Blackjack-v1", {"natural": True}),
        ("qtab:qtab/FrozenLake8x8-v1", {}),
    ],
)
def test_every_constructor_argument_has_its_effect(name, env_kwargs):
    same_everywhere(name, env_kwargs=env_kwargs, episodes=40, max_episode_steps=100, epsilon=0.9)


@pytest.fixture(scope="module")
def taxi_table():
    """Action values that drive well: at random a taxi seldom picks up a passenger, and a fickle one never shows."""
    return qtab.train("Taxi-v4", seed=0).q_table


@pytest.mark.parametrize(
    ("name", "env_kwargs"),
    [
        ("Taxi-v4", {"is_rainy": True}),
        ("Taxi-v4", {"fickle_passenger": True}),
        ("Taxi-v4", {"is_rainy": True, "fickle_passenger": True, "fickle_probability": 0.9, "rainy_probability": 0.5}),
        ("qtab/Taxi-v4", {"fickle_passenger": True}),
    ],
)
def test_every_variant_of_the_taxi_is_trained_the_same(name, env_kwargs, taxi_table):
    run = same_everywhere(name, env_kwargs=env_kwargs, episodes=50, epsilon=0.3, initial_q=taxi_table)
    assert run.terminated.sum() > 25


@pytest.mark.parametrize("rate", [1.5, np.float32(0.7)])
def test_a_table_whose_probabilities_do_not_sum_to_1_is_stepped_in_gymnasium(rate):
    kwargs = {"success_rate": rate}
    run = qtab.train("FrozenLake-v1", env_kwargs=kwargs, **SETTINGS)
    assert run.config.backend == "gymnasium"
    assert qtab.verify(run).equal
    match = r"backend must be .* for this environment, got 'rust': P\[0\]\[0\]\[0\]"
    with pytest.raises(ValueError, match=match):
        qtab.train("FrozenLake-v1", env_kwargs=kwargs, backend="rust", **SETTINGS)


@pytest.mark.parametrize("name", [name for name in IDS if "Slippery" not in name])
def test_every_preset_learns(name):
    runs = [qtab.train(name, seed=seed) for seed in range(3)]
    played = [qtab.evaluate(run, episodes=1000, seed=9).mean_return for run in runs]
    # FrozenLake's thresholds, the shortest path along the cliff, and near the optimum of the others.
    least = {"FrozenLake-v1": 0.7, "FrozenLake8x8-v1": 0.85, "CliffWalking-v1": -13, "Taxi-v4": 7.5}
    assert min(played) >= least.get(name, -0.1)


def test_the_books_cliff_is_a_preset():
    assert list(qtab.presets("CliffWalking-v1")) == ["tuned", "book", "solved"]
    assert qtab.train("CliffWalking-v1", preset="book", episodes=20, seed=0).config.epsilon_schedule == "constant"


def test_an_environment_without_a_time_limit_gets_one_in_training():
    run = qtab.train("CliffWalking-v1", epsilon=0.0, learning_rate=0.0, initial_q=0.0, episodes=2, seed=0)
    assert run.config.max_episode_steps == 10_000
    assert run.episode_lengths.tolist() == [10_000, 10_000]
    assert not run.terminated.any()
    assert gym.spec("qtab/CliffWalking-v1").max_episode_steps is None
    assert qtab.verify(run).equal


class Steps(gym.Env):
    """Shows random observations of a discrete space, or a given one; rewards depend on the action."""

    def __init__(self, space: gym.Space[Any], shown: Any = None) -> None:
        self.observation_space, self.action_space = space, Discrete(3, start=2)
        self.shown = shown

    def _show(self) -> Any:
        return self.observation_space.sample() if self.shown is None else self.shown

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        super().reset(seed=seed)
        if seed is not None:
            self.observation_space.seed(seed)
        return self._show(), {}

    def step(self, action: int) -> Any:
        assert self.action_space.contains(action)
        return self._show(), float(action) / 7.0, bool(self.np_random.random() < 0.1), False, {}


SPACES = [
    Discrete(7),
    Discrete(4, start=-3),
    Discrete(3, start=2**40),
    MultiDiscrete([3, 4]),
    MultiDiscrete([3, 4, 2], start=[-1, 0, 5]),
    MultiDiscrete([5], dtype=np.int8),
    Tuple((Discrete(3), Discrete(2, start=-1))),
    Tuple((Discrete(5),)),
]


@pytest.mark.parametrize("space", SPACES, ids=str)
def test_every_discrete_space_is_supported_and_its_start_subtracted(space, tmp_path):
    env = Steps(space)
    run = qtab.train(env, **SETTINGS)
    assert (run.config.discretizer, run.config.backend) == ("identity", "gymnasium")
    assert qtab.verify(run, env=env).equal
    for _ in range(20):
        observation = space.sample()
        action, _ = run.predict(observation)
        assert action == np.argmax(run.q_values(observation)) + 2
    first = run.discretizer.low[()] if space.__class__ is Discrete else tuple(np.ravel(run.discretizer.low))
    assert np.array_equal(run.q_values(first), run.q_table[(0,) * len(run.discretizer.shape)])
    run.save(tmp_path / "run.npz")
    assert_same_run(run, qtab.load(tmp_path / "run.npz"))
    assert qtab.load(tmp_path / "run.npz").q_table.shape == run.q_table.shape
    assert qtab.evaluate(run, episodes=3, seed=1, env=env).lengths.sum() > 0


@pytest.mark.parametrize(
    ("space", "shown", "text"),
    [
        (Discrete(3), 3, r"observation\[0\] is 3, outside the observation space"),
        (Discrete(3, start=1), 0, r"observation\[0\] is 0, outside"),
        (Discrete(3), -1, r"observation\[0\] is -1, outside"),
        (Discrete(3), 1.5, "an observation must be an integer, as the space's are, got 1.5"),
        (Discrete(3), "left", "an observation must be an integer"),
        (Discrete(3), (1,), "an observation must be an integer"),
        (MultiDiscrete([3, 2]), np.array([1, 2]), r"observation\[1\] is 2, outside"),
        (MultiDiscrete([3, 2]), np.array([1, 1, 1]), "an observation must hold 2 integers"),
        (Tuple((Discrete(3), Discrete(2))), (1,), "an observation must hold 2 integers"),
        (Tuple((Discrete(3), Discrete(2))), 1, "an observation must hold 2 integers"),
        (Tuple((Discrete(3), Discrete(2))), (1, "a"), "an observation must hold 2 integers"),
    ],
    ids=str,
)
def test_an_observation_outside_the_space_is_refused(space, shown, text):
    with pytest.raises(ValueError, match=text):
        qtab.train(Steps(space, shown), **SETTINGS)


def test_a_run_refuses_invalid_observations():
    run = qtab.train("FrozenLake-v1", **SETTINGS)
    with pytest.raises(ValueError, match=r"observation\[0\] is 16, outside the observation space"):
        run.predict(16)
    with pytest.raises(ValueError, match=r"observations must have shape \(\) or \(n,\), got \(1, 1\)"):
        run.predict([[3]])
    with pytest.raises(TypeError, match="observation must hold integers"):
        run.predict(3.0)


@pytest.mark.parametrize(
    ("env", "settings", "text"),
    [
        ("FrozenLake-v1", {"scale": (1.0,)}, "scale applies to discretizer 'round', not to 'identity'"),
        ("FrozenLake-v1", {"discretizer": "tiles"}, "the observation space must be a Box"),
        ("MountainCar-v0", {"discretizer": "identity"}, "the observation space must be discrete"),
        (Steps(Discrete(2**33)), {}, r"the observation space must give a table of fewer than 2\*\*32 values"),
        (Steps(Box(0, 1, (2, 2))), {}, "scale must be given and hold 4 numbers .* or discretizer='bins' or 'tiles'"),
        (Steps(Tuple((Discrete(2), Box(0, 1, (1,))))), {}, "scale must be given and hold 1 number for"),
    ],
    ids=str,
)
def test_settings_that_do_not_fit_are_refused(env, settings, text):
    with pytest.raises(ValueError, match=text):
        qtab.train(env, episodes=1, seed=0, **settings)


@pytest.mark.parametrize("name", IDS)
def test_recorded_episodes_can_be_replayed(name):
    from qtab.rendering.replay import make_render_env, replay_all

    run = qtab.train(name, record=40, **SETTINGS)
    assert len(run.recordings) == 40
    mode = "ansi" if name != "Blackjack-v1" else "rgb_array"
    env = make_render_env(run.config, mode)
    assert replay_all(env, run, progress=False) == 0
    env.close()


def test_the_articles_terminal_update_can_be_chosen():
    same_everywhere("FrozenLake-v1", terminal_update="assign")


@pytest.mark.parametrize("name", ["FrozenLake-v1", "Taxi-v4", "Blackjack-v1"])
def test_many_runs_equal_single_runs(name):
    settings: dict[str, Any] = {**SETTINGS, "episodes": 60}
    del settings["seed"]
    runs = qtab.train_many(name, seeds=5, tables=True, **settings)
    assert runs.config.backend == "rust"
    for seed, run in zip(runs.seeds, runs, strict=True):
        assert_same_run(run, qtab.train(name, seed=seed, **settings))
