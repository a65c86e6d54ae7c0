"""Environments written as functions of their state: Gymnasium's API, and clear errors."""

import copy
import pickle
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium import spaces
from gymnasium.utils.env_checker import check_env

import qtab
from support.environments.own.control.mountain_car import MountainCar
from support.environments.own.games.tic_tac_toe import TicTacToe
from support.environments.own.grids.key_and_door import KeyAndDoor


class Counter(qtab.FunctionalEnv):
    """Counts to ten; what its methods return can be replaced."""

    observation_space: gym.Space[Any] = spaces.Discrete(11)
    action_space: gym.Space[Any] = spaces.Discrete(2, start=3)

    def __init__(self, **returned: Any) -> None:
        self.returned = returned

    def initial_state(self, rng: np.random.Generator) -> Any:
        return self.returned.get("initial_state", 0)

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        return self.returned.get("transition", (state + action - 3, -1.0, state >= 9))

    def observe(self, state: Any) -> Any:
        return self.returned.get("observe", state)


class Masked(Counter):
    def action_mask(self, state: Any) -> Any:
        return self.returned.get("action_mask", [True, state > 0])


class Drawn(qtab.FunctionalEnv):
    """Has no constructor, and pictures in two modes."""

    observation_space = spaces.Box(0.0, 1.0, (1,))
    action_space = spaces.Discrete(2)
    metadata = {"render_modes": ["human", "rgb_array"], "render_fps": 5}  # noqa: RUF012
    drawn: list[float] = []  # noqa: RUF012

    def initial_state(self, rng: np.random.Generator) -> float:
        return rng.random()

    def transition(self, state: float, action: int, rng: np.random.Generator) -> tuple[float, float, bool]:
        return state / 2, 0.0, state < 0.01

    def observe(self, state: float) -> float:
        return state

    def render(self, state: Any = None) -> Any:
        self.drawn.append(state)
        return np.full((2, 2, 3), round(255 * state), np.uint8) if self.render_mode == "rgb_array" else None


@pytest.mark.parametrize("made", [KeyAndDoor, MountainCar, TicTacToe, Drawn])
def test_gymnasium_accepts_it(made: Any) -> None:
    if made is not TicTacToe:  # the checker takes actions whether they are available or not
        check_env(made(), skip_render_check=True)
    env = made()
    first, info = env.reset(seed=3)
    assert isinstance(env, gym.Env)
    assert first in env.observation_space
    assert ("action_mask" in info) == (made is TicTacToe)


@pytest.mark.parametrize("made", [KeyAndDoor, MountainCar])
def test_a_seed_repeats_an_episode(made: Any) -> None:
    one, other = made(), made()
    for seed in (3, None):
        np.testing.assert_array_equal(one.reset(seed=seed)[0], other.reset(seed=seed)[0])
        for action in (0, 1, 1, 0) * 5:
            ours, theirs = one.step(action), other.step(np.int64(action))
            np.testing.assert_array_equal(ours[0], theirs[0])
            assert ours[1:] == theirs[1:]
    assert one.np_random.bit_generator.state == other.np_random.bit_generator.state


def test_it_equals_gymnasiums_mountain_car() -> None:
    mine, theirs = gym.wrappers.TimeLimit(MountainCar(), 200), gym.make("MountainCar-v0")
    for episode in range(3):
        seed = 5 if episode == 0 else None
        observation, expected = mine.reset(seed=seed)[0], theirs.reset(seed=seed)[0]
        assert observation.tobytes() == expected.tobytes()
        for action in np.random.default_rng(episode).integers(0, 3, 200):
            ours, others = mine.step(action), theirs.step(action)
            assert np.asarray(ours[0]).tobytes() == np.asarray(others[0]).tobytes()
            assert ours[1:4] == others[1:4]


def test_it_works_with_register_make_and_wrappers() -> None:
    gym.register(
        "KeyAndDoor-v0",
        "support.environments.own.grids.key_and_door:KeyAndDoor",
        max_episode_steps=9,
        kwargs={"length": 5},
    )
    try:
        env = gym.wrappers.RecordEpisodeStatistics(gym.make("KeyAndDoor-v0", slip=0.0))
        env.reset(seed=1)
        steps = 0
        while True:
            *_, terminated, truncated, info = env.step(steps % 2)
            steps += 1
            if terminated or truncated:
                break
        assert (steps, truncated) == (9, True)
        assert info["episode"]["l"] == 9
        run = qtab.train("KeyAndDoor-v0", episodes=5, seed=0)
        assert run.episode_lengths.max() <= 9
        vector = gym.make_vec("KeyAndDoor-v0", num_envs=2)
        assert vector.reset(seed=0)[0].shape == (2, 2)
        vector.close()
    finally:
        del gym.registry["KeyAndDoor-v0"]


def test_training_in_python_is_verified() -> None:
    run = qtab.train(gym.wrappers.TimeLimit(TicTacToe(), 9), episodes=20, seed=0, action_mask=True)
    assert set(run.episode_returns) <= {-1.0, 0.0, 1.0}
    assert qtab.verify(run, env=gym.wrappers.TimeLimit(TicTacToe(), 9), episodes=5).table_equal


def test_the_state_can_be_read_set_and_given_at_a_reset() -> None:
    env = KeyAndDoor()
    with pytest.raises(gym.error.ResetNeeded, match="KeyAndDoor has no state before reset"):
        env.state  # noqa: B018
    with pytest.raises(gym.error.ResetNeeded, match="KeyAndDoor has no state before reset"):
        env.step(0)
    observation, _ = env.reset(options={"state": (4, True)})
    assert env.state == (4, True)
    assert observation.tolist() == [4, 1]
    env.state = 18, True
    env.slip = 0.0
    assert env.step(1)[1:3] == (1.0, True)
    with pytest.raises(ValueError, match=r"^state must be a tuple of 2 numbers, as before, got a number$"):
        env.state = 3
    with pytest.raises(ValueError, match=r"^options\['state'\] must be a tuple of 2 numbers, .* got a tuple of 3 num"):
        env.reset(options={"state": (1, 2, 3)})


def test_copies_and_pickles_continue_alike() -> None:
    env = KeyAndDoor()
    env.reset(seed=0)
    twins = [copy.deepcopy(env), pickle.loads(pickle.dumps(env))]  # noqa: S301
    for action in (0, 1, 1, 1):
        expected = env.step(action)
        for twin in twins:
            np.testing.assert_array_equal(twin.step(action)[0], expected[0])


def test_observations_belong_to_the_caller() -> None:
    env = TicTacToe()
    observation, _ = env.reset(seed=0)
    observation[:] = 2
    assert env.state.tolist() == [0] * 9


def test_pictures() -> None:
    env = Drawn(render_mode="rgb_array")
    env.reset(seed=0)
    assert env.render().shape == (2, 2, 3)
    assert env.render(0.0).max() == 0.0
    with pytest.raises(ValueError, match=r"render_mode must be None or one of \['human', 'rgb_array'\], got 'ansi'"):
        Drawn(render_mode="ansi")
    Drawn.drawn.clear()
    human = Drawn(render_mode="human")
    human.reset(seed=0)
    human.step(0)
    assert len(Drawn.drawn) == 2
    with pytest.raises(NotImplementedError, match=r"KeyAndDoor has no method render\(self, state\)"):
        KeyAndDoor().render()
    game: Any = TicTacToe()
    game.reset()
    assert game.render() == "...\n...\n..."


def test_a_missing_method_or_space_is_named() -> None:
    class Broken(qtab.FunctionalEnv):
        def initial_state(self, rng: np.random.Generator) -> int:
            return 0

        def observe(self, state: int) -> int:
            return state

    with pytest.raises(TypeError, match=r"Broken .* abstract method '?transition"):
        Broken()  # type: ignore[abstract]

    class Spaceless(Broken):
        def transition(self, state: int, action: int, rng: np.random.Generator) -> tuple[int, float, bool]:
            return state, 0.0, False

    with pytest.raises(AttributeError, match="Spaceless must have an attribute observation_space, a space of Gymn"):
        Spaceless().reset()


AT_RESET: list[tuple[Any, dict[str, Any], str]] = [
    (Counter, {"observe": 11}, r"observe of Counter must return an element of Discrete\(11\), got 11"),
    (Counter, {"observe": 1.5}, "observe of Counter must return an integer, got 1.5"),
    (Masked, {"action_mask": [False, False]}, r"action_mask of Masked must leave at least one action, got \[False"),
    (Masked, {"action_mask": [True]}, r"action_mask of Masked must have shape \(2,\)"),
]
IN_A_STEP: list[tuple[Any, dict[str, Any], str]] = [
    (
        Counter,
        {"transition": (1, 0.0)},
        r"transition of Counter must return \(state, reward, terminated\), got 2 values",
    ),
    (Counter, {"transition": 5}, r"transition of Counter must return \(state, reward, terminated\), got 5"),
    (Counter, {"transition": ((1, 2), 0.0, False)}, "must return a number, as before, got a tuple of 2 numbers"),
    (Counter, {"transition": ([1], 0.0, False)}, "must return a number, as before, got a list"),
    (Counter, {"transition": (np.zeros(2), 0.0, False)}, r"a number, as before, got an array of shape \(2,\)"),
    (Counter, {"transition": (1, "a", False)}, "must return a number as the reward, got 'a'"),
    (
        Counter,
        {"transition": (1, -np.inf, False)},
        "transition of Counter must return a finite number as the reward, got",
    ),
    (Counter, {"transition": (1, 0.0, 1)}, "must return a boolean as terminated, got 1"),
    (Counter, {"transition": (12, 0.0, False)}, r"must return an element of Discrete\(11\), got 12"),
]


@pytest.mark.parametrize(("made", "returned", "message"), AT_RESET, ids=[message for *_, message in AT_RESET])
def test_a_wrong_value_at_a_reset_is_refused(made: Any, returned: Any, message: str) -> None:
    with pytest.raises((TypeError, ValueError), match=message):
        made(**returned).reset(seed=0)


@pytest.mark.parametrize(("made", "returned", "message"), IN_A_STEP, ids=[message for *_, message in IN_A_STEP])
def test_a_wrong_value_in_a_step_is_refused_and_leaves_the_state(made: Any, returned: Any, message: str) -> None:
    env = made(**returned)
    env.reset(seed=0)
    with pytest.raises((TypeError, ValueError), match=message):
        env.step(3)
    assert env.state == 0


def test_an_action_outside_the_space_is_refused() -> None:
    env = Counter()
    env.reset(seed=0)
    with pytest.raises(gym.error.InvalidAction, match=r"action must be in Discrete\(2, start=3\), got 2"):
        env.step(2)
    assert env.step(4)[0] == 1


def test_the_mask_of_a_terminal_state_may_be_empty() -> None:
    env = Masked(transition=(0, 0.0, True), action_mask=None)
    env.returned["action_mask"] = [True, True]
    env.reset(seed=0)
    env.returned["action_mask"] = [False, False]
    assert env.step(3)[4]["action_mask"].tolist() == [0, 0]
