"""Visits and snapshots: what they count and copy, and that they change nothing."""

from typing import Any, get_args

import gymnasium as gym
import numpy as np
import pytest
from hypothesis import assume, given, settings

import qtab
from qtab.cli.command import parser_of
from qtab.cli.commands import train
from qtab.cli.errors import UsageError
from qtab.config.choices import Algorithm
from qtab.reference import LEARNERS
from qtab.reference.parts.actions import actions
from qtab.reference.parts.observations import discretizer
from support.files.run_files import members_of, with_right_digest, write_members
from support.learners.learner_settings import CAR, TRAINED, run_settings

ALGORITHMS = get_args(Algorithm)


class Counter(gym.Wrapper[Any, Any, Any, Any]):
    """Counts with NumPy's discretizers what the reference does in an environment."""

    def __init__(self, run: qtab.Run) -> None:
        config = run.config
        super().__init__(gym.make(config.env, max_episode_steps=config.max_episode_steps, **config.env_kwargs))
        self.discretizer = discretizer(self.env, config)
        self.columns = [np.asarray(action).tolist() for action in actions(self.env, config)]
        self.visits = np.zeros((run.discretizer.n_rows, len(self.columns)), np.int64)
        self.rows: list[int] = []

    def reset(self, **kwargs: Any) -> Any:
        observation, info = self.env.reset(**kwargs)
        self.rows = self.discretizer.rows(observation)
        return observation, info

    def step(self, action: Any) -> Any:
        column = self.columns.index(np.asarray(action).tolist())
        for row in self.rows:
            self.visits[row, column] += 1
        answer = self.env.step(action)
        self.rows = self.discretizer.rows(answer[0])
        return answer


def visits_of_the_reference(run: qtab.Run) -> Any:
    assert run.visits is not None
    counter = Counter(run)
    LEARNERS[run.config.algorithm](counter, run.config)
    counter.close()
    return counter.visits.reshape(run.visits.shape)


OF_EVERY_KIND = ("q_learning", "n_step_sarsa", "true_online_sarsa_lambda", "dyna_q", "actor_critic")


@pytest.mark.parametrize(
    ("env", "algorithm"),
    [
        pytest.param(*env.values, algorithm, marks=env.marks)
        for env in TRAINED
        for algorithm in (ALGORITHMS if env.values == (CAR,) else OF_EVERY_KIND)
    ],
)
def test_visits_are_those_of_the_reference(algorithm: Any, env: str) -> None:
    profile: Any = settings.default

    @settings(max_examples=max(1, profile.max_examples // 15), deadline=None)
    @given(run_settings(algorithm, env))
    def check(chosen: dict[str, Any]) -> None:
        try:
            run = qtab.train(env, visits=True, **chosen)
        except OverflowError:
            return
        values = run.actions.values
        # The reference passes actions to the environment, not columns: equal ones cannot be told apart.
        assume(values is None or len(np.unique(values, axis=0)) == len(values))
        assert run.visits is not None
        assert run.visits.dtype == np.int64
        np.testing.assert_array_equal(run.visits, visits_of_the_reference(run))

    check()


@pytest.mark.parametrize("env", ["FrozenLake-v1", "Taxi-v4", "Blackjack-v1", "CartPole-v1"])
@pytest.mark.parametrize("algorithm", ["q_learning", "sarsa", "expected_sarsa", "double_q_learning"])
def test_visits_of_each_environment_are_those_of_the_reference(env: str, algorithm: Any) -> None:
    run = qtab.train(env, algorithm=algorithm, episodes=10, seed=1, visits=True, max_episode_steps=50)
    np.testing.assert_array_equal(run.visits, visits_of_the_reference(run))


@pytest.mark.parametrize("preset", ["article", "solved"])
@pytest.mark.parametrize("backend", ["rust", "gymnasium"])
def test_counting_and_copying_change_nothing(preset: str, backend: Any) -> None:
    chosen: dict[str, Any] = {"preset": preset, "episodes": 12, "seed": 3, "backend": backend}
    plain = qtab.train(CAR, **chosen)
    counted = qtab.train(CAR, visits=True, snapshots=5, record=1, **chosen)
    assert plain.visits is None
    assert plain.snapshots is None
    assert counted.visits is not None
    assert counted.tables.tobytes() == plain.tables.tobytes()
    assert counted.episode_returns.tobytes() == plain.episode_returns.tobytes()
    assert counted.visits.sum() == plain.episode_lengths.sum() * plain.discretizer.n_active


def test_snapshots_are_the_tables_of_shorter_runs() -> None:
    run = qtab.train(CAR, episodes=40, seed=2, snapshots=(40, 0, 7, 7, 20), callback=lambda _: None, callback_every=9)
    assert run.snapshots is not None
    assert run.snapshots.episodes.tolist() == [0, 7, 20, 40]
    assert run.snapshots.tables.shape == (4, *run.tables.shape)
    assert run.snapshots.tables[-1].tobytes() == run.tables.tobytes()

    def stop_at(episode: int) -> qtab.Run:
        return qtab.train(CAR, episodes=40, seed=2, callback=lambda _: False, callback_every=episode)

    for index, episode in ((1, 7), (2, 20)):
        assert run.snapshots.tables[index].tobytes() == stop_at(episode).tables.tobytes()
    low, high = run.snapshots.tables[0].min(), run.snapshots.tables[0].max()
    assert -1 <= low < high <= 1  # the article's random first values


@pytest.mark.parametrize(
    ("snapshots", "episodes"),
    [
        (1, [10]),
        (4, [2, 5, 7, 10]),
        (99, list(range(1, 11))),
        (0, None),
        ([10], [10]),
        (np.array([0, 2, 10]), [0, 2, 10]),
        (np.array([3]), [3]),
        (np.array(2), [5, 10]),
    ],
)
def test_a_number_of_snapshots_is_spread_over_the_run(snapshots: Any, episodes: list[int] | None) -> None:
    kept = qtab.train("FrozenLake-v1", episodes=10, seed=0, snapshots=snapshots).snapshots
    assert (None if kept is None else kept.episodes.tolist()) == episodes


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"snapshots": -1}, ValueError, "snapshots must be an integer of at least 0, got -1"),
        ({"snapshots": 2.5}, TypeError, "snapshots must be an integer or a sequence of episode numbers, got 2.5"),
        ({"snapshots": True}, TypeError, "snapshots must be an integer or a sequence of episode numbers, got True"),
        ({"snapshots": "3"}, TypeError, "snapshots must be an integer or a sequence of episode numbers, got '3'"),
        ({"snapshots": []}, ValueError, "snapshots must be a number, or hold at least one episode number"),
        ({"snapshots": np.array([2.5])}, TypeError, r"^snapshots\[0\] must be an integer from 0 to 10, got .*2\.5"),
        ({"snapshots": np.array([[1, 2]])}, TypeError, r"^snapshots\[0\] must be an integer from 0 to 10, got "),
        ({"snapshots": [11]}, ValueError, r"^snapshots\[0\] must be an integer from 0 to 10, got 11$"),
        ({"visits": 1}, TypeError, "visits must be True or False, got 1"),
    ],
)
def test_bad_arguments_are_named(arguments: dict[str, Any], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        qtab.train("FrozenLake-v1", episodes=10, seed=0, **arguments)


def test_an_interrupted_run_keeps_what_was_counted_and_copied() -> None:
    def fail(progress: qtab.Progress) -> None:
        if progress.episodes == 20:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as caught:
        qtab.train(CAR, episodes=100, seed=0, visits=True, snapshots=10, callback=fail, callback_every=10)
    run: Any = caught.value.run  # type: ignore[attr-defined]
    assert run.snapshots.episodes.tolist() == [10, 20]
    assert run.visits.sum() == run.episode_lengths.sum()


def test_a_saved_run_keeps_them(tmp_path: Any) -> None:
    run = qtab.train(CAR, preset="solved", episodes=5, seed=0, visits=True, snapshots=2)
    run.save(tmp_path / "run.npz")
    loaded = qtab.load(tmp_path / "run.npz")
    assert loaded.visits is not None
    assert run.visits is not None
    assert run.snapshots is not None
    assert loaded.snapshots is not None
    assert loaded.visits.tobytes() == run.visits.tobytes()
    assert loaded.snapshots.episodes.tolist() == [2, 5]
    assert loaded.snapshots.tables.tobytes() == run.snapshots.tables.tobytes()
    qtab.train(CAR, episodes=5, seed=0).save(tmp_path / "plain.npz")
    plain = qtab.load(tmp_path / "plain.npz")
    assert plain.visits is None
    assert plain.snapshots is None


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("visits", np.zeros((19, 15, 3)), "its visits are not counts"),
        ("visits", np.full((19, 15, 3), -1), "its visits are not counts"),
        ("visits", np.zeros((19, 15, 2), np.int64), "its visits are not counts"),
        ("snapshot_episodes", np.array([5, 2]), "its snapshots are not at ascending episodes"),
        ("snapshot_episodes", np.array([2, 6]), "its snapshots are not at episodes of the run"),
        ("snapshot_episodes", np.array([5]), "its snapshots do not fit its tables"),
        ("snapshot_tables", np.zeros((2, 1, 285, 2)), "its snapshots do not fit its tables"),
    ],
)
def test_damaged_visits_and_snapshots_are_refused(tmp_path: Any, name: str, value: Any, message: str) -> None:
    qtab.train(CAR, episodes=5, seed=0, visits=True, snapshots=2).save(tmp_path / "run.npz")
    members = members_of(tmp_path / "run.npz") | {name: value}
    write_members(tmp_path / "damaged.npz", with_right_digest(members))
    with pytest.raises(ValueError, match=message):
        qtab.load(tmp_path / "damaged.npz")


def test_the_command_line_saves_them(tmp_path: Any, capsys: Any) -> None:
    arguments = ["FrozenLake-v1", "--episodes", "20", "--seed", "0", "--save", str(tmp_path / "run.npz")]
    assert train.run(parser_of("train", [*arguments, "--visits", "--snapshots", "4"]).read()) == 0
    run = qtab.load(tmp_path / "run.npz")
    assert run.visits is not None
    assert run.snapshots is not None
    assert run.snapshots.episodes.tolist() == [5, 10, 15, 20]
    capsys.readouterr()
    with pytest.raises(UsageError, match="snapshots must be an integer of at least 0, got -1"):
        train.run(parser_of("train", [*arguments, "--snapshots", "-1"]).read())
