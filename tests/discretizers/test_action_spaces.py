"""Discrete action spaces of every kind: their order, and that the environment gets its own values and dtypes."""

import copy
import itertools
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium import spaces

import qtab
from qtab.envs.actions import choose_actions, flat
from qtab.rendering.replay import replay_episode
from support.files.run_files import Members, members_of, with_header, without_digest, write_members


class Picky(gym.Env[Any, Any]):
    """Takes only actions that its space contains, and writes to those that it can."""

    def __init__(self, space: spaces.Space[Any]) -> None:
        self.action_space = space
        self.observation_space = spaces.Discrete(4)
        self.place = 0
        self.taken: list[Any] = []

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        super().reset(seed=seed)
        self.place = 0
        return 0, {}

    def step(self, action: Any) -> Any:
        assert self.action_space.contains(action), action
        self.taken.append(copy.deepcopy(action))
        total = sum(float(number) * (3 + index) for index, number in enumerate(flat(action)))
        _spoil(action)
        self.place = int(total + self.np_random.integers(2)) % 4
        return self.place, total - 0.3, self.place == 3, False, {}


def _spoil(action: Any) -> None:
    if isinstance(action, np.ndarray):
        action[...] = 0
    elif isinstance(action, tuple | dict):
        for part in action.values() if isinstance(action, dict) else action:
            _spoil(part)


NESTED = spaces.Tuple((spaces.Discrete(2), spaces.Dict({"b": spaces.MultiBinary(2), "a": spaces.Discrete(3, start=1)})))
SPACES: dict[str, tuple[spaces.Space[Any], list[Any]]] = {
    "discrete": (spaces.Discrete(3, start=-1), [[-1], [0], [1]]),
    "multi-discrete": (spaces.MultiDiscrete([2, 3]), [[x, y] for x in range(2) for y in range(3)]),
    "multi-discrete with start": (
        spaces.MultiDiscrete([2, 2], dtype=np.int32, start=[5, -1]),
        [[5, -1], [5, 0], [6, -1], [6, 0]],
    ),
    "multi-discrete of two axes": (
        spaces.MultiDiscrete(np.array([[2, 1], [1, 3]])),
        [[x, 0, 0, y] for x in range(2) for y in range(3)],
    ),
    "multi-binary": (spaces.MultiBinary(3), [list(bits) for bits in itertools.product((0, 1), repeat=3)]),
    "multi-binary of two axes": (
        spaces.MultiBinary((2, 1)),
        [list(bits) for bits in itertools.product((0, 1), repeat=2)],
    ),
    "tuple": (
        spaces.Tuple((spaces.Discrete(2), spaces.Discrete(2, start=7))),
        [[0, 7], [0, 8], [1, 7], [1, 8]],
    ),
    "dict": (
        spaces.Dict({"left": spaces.Discrete(2), "right": spaces.Discrete(3)}),
        [[x, y] for x in range(2) for y in range(3)],
    ),
    "nested": (
        NESTED,
        [[x, a, *bits] for x in range(2) for a in (1, 2, 3) for bits in itertools.product((0, 1), repeat=2)],
    ),
    "integer box": (spaces.Box(-1, 1, (2,), np.int8), [[x, y] for x in (-1, 0, 1) for y in (-1, 0, 1)]),
    "unsigned box of no axes": (spaces.Box(0, 3, (), np.uint8), [[x] for x in range(4)]),
}


@pytest.mark.parametrize("kind", SPACES)
def test_actions_are_enumerated_in_c_order(kind: str) -> None:
    space, expected = SPACES[kind]
    actions = choose_actions(space, None)
    listed = [actions[index] for index in range(len(actions))]
    assert [list(flat(action)) for action in listed] == expected
    assert all(space.contains(action) for action in listed)
    with pytest.raises(IndexError, match=f"^there are {len(expected)} actions, got index {len(expected)}"):
        actions[len(expected)]


@pytest.mark.parametrize("kind", SPACES)
def test_runs_train_verify_predict_replay_and_are_saved(kind: str, tmp_path: Any) -> None:
    space, expected = SPACES[kind]
    env = Picky(space)
    run = qtab.train(env, seed=0, episodes=30, epsilon=1.0, max_episode_steps=20, record=2, visits=True)
    assert len({tuple(flat(action)) for action in env.taken}) == len(expected)
    assert qtab.verify(run, env=Picky(space)).equal
    assert len(set(run.action_names)) == len(run.action_names) == len(expected)
    action, _ = run.predict(0)
    assert space.contains(action)
    _spoil(action)
    assert flat(run.predict(0)[0]) == expected[int(np.argmax(run.q_table[0]))]
    step = qtab.explain(run, episode=0, env=Picky(space))[0]
    assert step.action_name == run.action_names[step.choice.action]
    for recording in run.recordings:
        assert replay_episode(Picky(space), recording) == run.episode_returns[recording.episode]
    run.save(tmp_path / "run.npz")
    loaded = qtab.load(tmp_path / "run.npz")
    assert loaded.action_names == run.action_names
    assert repr(loaded.predict(0)) == repr(run.predict(0))
    assert qtab.verify(loaded, env=Picky(space)).equal
    played = qtab.evaluate(loaded, episodes=3, seed=0, env=Picky(space))
    assert played.returns.tobytes() == qtab.evaluate(run, episodes=3, seed=0, env=Picky(space)).returns.tobytes()
    assert (qtab.resume(loaded, 33, env=Picky(space)).episode_lengths[:30] == run.episode_lengths).all()


@pytest.mark.parametrize("kind", SPACES)
def test_a_batch_of_predictions_is_in_the_form_of_vector_environments(kind: str) -> None:
    space, _ = SPACES[kind]
    run = qtab.train(Picky(space), seed=0, episodes=3, max_episode_steps=20)
    batch, _ = run.predict(np.array([2, 0, 1]))
    one_by_one = list(gym.vector.utils.iterate(gym.vector.utils.batch_space(space, 3), batch))
    for action, observation in zip(one_by_one, (2, 0, 1), strict=True):
        assert list(flat(action)) == list(flat(run.predict(observation)[0]))
    assert [
        list(flat(action)) for action in gym.vector.utils.iterate(gym.vector.utils.batch_space(space, 4), run.policy)
    ] == [list(flat(run.predict(state)[0])) for state in range(4)]


@pytest.mark.parametrize(
    ("kind", "names"),
    [
        ("discrete", ("action -1", "action 0", "action 1")),
        ("multi-discrete with start", ("(5, -1)", "(5, 0)", "(6, -1)", "(6, 0)")),
        ("tuple", ("(0, 7)", "(0, 8)", "(1, 7)", "(1, 8)")),
        ("unsigned box of no axes", ("0", "1", "2", "3")),
    ],
)
def test_the_names_of_actions_are_their_values(kind: str, names: tuple[str, ...]) -> None:
    assert qtab.train(Picky(SPACES[kind][0]), seed=0, episodes=1).action_names == names


def test_a_dict_is_named_with_its_keys() -> None:
    names = qtab.train(Picky(NESTED), seed=0, episodes=1).action_names
    assert names[0] == "(0, {a: 1, b: (0, 0)})"


def test_some_actions_of_an_integer_box_can_be_listed() -> None:
    space = spaces.Box(0, 255, (2,), np.uint8)
    run = qtab.train(Picky(space), actions=((0, 255), (7, 9)), seed=0, episodes=2, max_episode_steps=20)
    assert {run.actions[index].tobytes() for index in range(2)} == {bytes([0, 255]), bytes([7, 9])}
    assert choose_actions(spaces.Box(0, 10, (1,), np.int64), 3).take(np.arange(3)).tolist() == [[0], [5], [10]]


@pytest.mark.parametrize(
    ("space", "message"),
    [
        (spaces.MultiBinary(20), r"at most 65536 actions, got MultiBinary\(20\) with 1,048,576; gymnasium.wrappers.Tr"),
        (spaces.MultiDiscrete([300, 300]), r"at most 65536 actions, got MultiDiscrete\(\[300 300\]\) with 90,000; "),
        (spaces.Box(0, 255, (3,), np.uint8), r"at most 65536 actions, got Box\(.*\) with 16,777,216; actions= can "),
        (spaces.Box(-(2**62), 2**62, (9,), np.int64), r"at most 65536 actions, got Box\(.*\) with 4.83e\+170"),
        (spaces.Tuple([spaces.Discrete(300)] * 2), r"at most 65536 actions, got Tuple\(.*\) with 90,000; "),
        (spaces.Tuple(()), r"at least one component, got Tuple\(\)"),
        (spaces.Tuple((spaces.Discrete(2), spaces.Box(0, 1))), r"only discrete spaces if it is a Tuple or a Dict, got"),
        (spaces.Text(3), r"Discrete, MultiDiscrete, .* got Text\(.*gymnasium.wrappers.TransformAction"),
        (spaces.Sequence(spaces.Discrete(2)), r"Discrete, MultiDiscrete, .* got Sequence\("),
    ],
    ids=str,
)
def test_spaces_that_cannot_be_enumerated_are_refused(space: spaces.Space[Any], message: str) -> None:
    with pytest.raises(ValueError, match=rf"^the action space must (have|hold|be) {message}"):
        qtab.train(Picky(space), seed=0, episodes=1)


def test_actions_apply_to_boxes_only() -> None:
    with pytest.raises(
        ValueError, match=r"^actions applies to Box action spaces only, and this one is MultiBinary\(2\)"
    ):
        qtab.train(Picky(spaces.MultiBinary(2)), actions=2, seed=0, episodes=1)


def test_masks_cover_all_combinations() -> None:
    space = spaces.MultiDiscrete([2, 3])
    env = Picky(space)
    run = qtab.train(env, action_mask=lambda state: [1, 0, 0, 0, 1, state > 0], seed=0, episodes=20)
    assert {tuple(action.tolist()) for action in env.taken} == {(0, 0), (1, 1), (1, 2)}
    assert qtab.verify(run, env=Picky(space)).equal


@pytest.fixture(scope="module")
def members(tmp_path_factory: pytest.TempPathFactory) -> Members:
    path = tmp_path_factory.mktemp("saved") / "run.npz"
    qtab.train(Picky(NESTED), seed=0, episodes=2, max_episode_steps=9).save(path)
    return without_digest(members_of(path))


@pytest.mark.parametrize(
    "parts",
    [
        None,
        [],
        {},
        {"parts": [], "keys": None},
        {"parts": [3], "keys": None},
        {"count": 24, "first": 0},
        {"parts": [{"count": 24, "first": 0.5}], "keys": None},
        {"parts": [{"count": 10**9, "first": 0}], "keys": None},
        {"parts": [{"count": 24, "first": 0}], "keys": ["a", "b"]},
        {"parts": [{"count": 24, "first": 0}], "keys": [1]},
        {"parts": [{"count": 25, "first": 0}], "keys": None},
        {"parts": [{"dtype": "O", "values": [1] * 24}], "keys": None},
        {"parts": [{"dtype": "int8", "values": 24}], "keys": None},
        {"parts": [{"dtype": "int8", "values": [[1], []] * 12}], "keys": None},
        {"parts": [{"dtype": "int8", "values": [0.5] * 24}], "keys": None},
        {"parts": [{"parts": [{"count": 24}], "keys": None}], "keys": None},
    ],
    ids=str,
)
def test_a_file_whose_actions_do_not_fit_is_refused(members: Members, tmp_path: Any, parts: Any) -> None:
    write_members(tmp_path / "run.npz", with_header(members, lambda header: header.update(action_parts=parts)))
    if parts is None:
        assert qtab.load(tmp_path / "run.npz").actions[0] == 0
        return
    with pytest.raises(ValueError, match="is not a run file that this version of qtab can read: "):
        qtab.load(tmp_path / "run.npz")


@pytest.mark.parametrize(
    "change", [lambda masks: masks[1:], lambda masks: masks.astype(np.int8), lambda masks: masks & False], ids=range(3)
)
def test_a_file_whose_masks_do_not_fit_is_refused(tmp_path: Any, change: Any) -> None:
    path = tmp_path / "run.npz"
    qtab.train("Taxi-v4", action_mask=True, seed=0, episodes=1).save(path)
    members = without_digest(members_of(path))
    members["action_masks"] = change(members["action_masks"])
    write_members(path, members)
    with pytest.raises(ValueError, match=r"its action masks are not booleans of shape \(500, 6\)"):
        qtab.load(path)
