"""Evaluations during a run, the best of them, and stopping at a return."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.callbacks import CSVLogger, EvaluateEvery, KeepBest, StopAtReturn
from support.environments import Walk
from support.parity import assert_same_run, run_of

LAKE: dict[str, Any] = {"env": "FrozenLake-v1", "seed": 3, "episodes": 3000}


def test_an_evaluation_is_that_of_the_run_at_the_time():
    evaluation = EvaluateEvery(episodes=30, every=1000, seed=7)
    qtab.train(**LAKE, callback=evaluation)
    assert evaluation.evaluated_at == [1000, 2000, 3000]
    for episodes, evaluated in zip(evaluation.evaluated_at, evaluation.evaluations, strict=True):
        stopped = qtab.train(**LAKE, callback=lambda now, at=episodes: now.episodes < at, callback_every=1000)
        again = qtab.evaluate(stopped, 30, seed=7)
        assert evaluated.returns.tobytes() == again.returns.tobytes()
        assert evaluated.seed == 7
    assert evaluation.mean_returns.tolist() == [evaluated.mean_return for evaluated in evaluation.evaluations]


def test_the_seed_is_derived_from_that_of_the_run_and_is_another_one():
    seeds = set()
    for seed in (0, 1, 2**70):
        evaluation = EvaluateEvery(episodes=1, every=5)
        qtab.train("FrozenLake-v1", seed=seed, episodes=10, callback=evaluation)
        (own,) = {evaluated.seed for evaluated in evaluation.evaluations}
        assert own != seed
        seeds.add(own)
    assert len(seeds) == 3


def test_an_environment_of_ones_own_is_evaluated_in_another_one():
    chosen: dict[str, Any] = {"discretizer": "bins", "bins": 5, "episodes": 6, "seed": 1, "max_episode_steps": 9}
    with pytest.raises(ValueError, match=r"^env must be given: no other environment can be made from 'Walk'$"):
        qtab.train(Walk(), callback=EvaluateEvery(), **chosen)
    trained, other = Walk(), Walk()
    same = gym.wrappers.TimeLimit(trained, 5)
    with pytest.raises(ValueError, match=r"^env must not be the environment that is trained in"):
        qtab.train(trained, callback=KeepBest(env=same), **chosen)
    evaluation = EvaluateEvery(episodes=2, every=3, env=other)
    qtab.train(trained, callback=evaluation, **chosen)
    assert evaluation.evaluated_at == [3, 6]


class Scaled(gym.RewardWrapper[Any, Any]):
    def __init__(self, env: gym.Env, factor: float) -> None:
        super().__init__(env)
        self.factor = factor

    def reward(self, reward: Any) -> Any:
        return self.factor * float(reward)


def test_an_id_does_not_stand_for_an_environment_with_more_wrappers():
    wrapped = Scaled(gym.make("MountainCar-v0"), 2.0)
    message = "^env must be given: .* the arguments of its wrapper Scaled are not known$"
    with pytest.raises(ValueError, match=message):
        qtab.train(wrapped, episodes=3, callback=EvaluateEvery())


def test_evaluations_take_place_in_the_environment_of_the_training():
    env: Any = gym.make("MountainCar-v0", max_episode_steps=30)
    env.unwrapped.goal_position = -0.5
    best = KeepBest(episodes=2)
    qtab.train(env, episodes=20, seed=0, callback=best)
    assert best.best_return is not None
    assert best.best_return > -30  # the usual goal is out of reach within 30 steps


def test_an_exception_in_an_evaluation_carries_the_run_that_is_trained():
    class Broken(Walk):
        def step(self, action: Any) -> Any:
            raise KeyboardInterrupt

    chosen: dict[str, Any] = {"discretizer": "bins", "bins": 5, "episodes": 6, "seed": 1, "max_episode_steps": 9}
    with pytest.raises(KeyboardInterrupt) as caught:
        qtab.train(Walk(), callback=EvaluateEvery(every=4, env=Broken()), **chosen)
    run = run_of(caught.value)
    assert run.config.learning_rate != 0.0  # an evaluation has that of 0
    assert len(run.episode_returns) == 4


def test_the_best_table_is_kept(tmp_path):
    best = KeepBest(tmp_path / "best.npz", episodes=50, every=250, seed=7)
    qtab.train(**LAKE, callback=best)
    assert best.run is not None
    means = best.mean_returns
    assert len(set(means.tolist())) > 2
    assert best.best_return == means.max()
    at = best.evaluated_at[int(np.argmax(means))]
    stopped = qtab.train(**LAKE, callback=lambda now: now.episodes < at, callback_every=250)
    assert_same_run(best.run, stopped)
    assert_same_run(qtab.load(tmp_path / "best.npz"), stopped)
    assert qtab.evaluate(best.run, 50, seed=7).mean_return == best.best_return


def test_the_best_table_of_the_earlier_part_is_kept_where_a_run_is_resumed(tmp_path):
    path, short = tmp_path / "best.npz", {**LAKE, "episodes": 1500, "learning_rate": 1.0}
    whole = KeepBest(episodes=50, every=250, seed=7)
    qtab.train(**short, callback=whole)
    at = whole.evaluated_at[int(np.argmax(whole.mean_returns))]
    assert at < 1500
    part = qtab.train(
        **short, callback=[KeepBest(path, 50, 250, seed=7), lambda now: now.episodes < at], callback_every=250
    )
    best = KeepBest(path, 50, 250, seed=7)
    qtab.resume(part, callback=best)
    assert best.run is not None
    assert whole.run is not None
    assert best.best_return == whole.best_return
    assert_same_run(best.run, whole.run)
    assert_same_run(qtab.load(path), whole.run)


@pytest.mark.parametrize(
    "function", [{"discretizer": lambda cell: cell // 2, "shape": (8,)}, {"action_mask": lambda _: np.arange(4) > 0}]
)
def test_the_best_table_of_a_run_with_a_function_is_kept_where_it_is_resumed(tmp_path, function):
    path, short = tmp_path / "best.npz", {**LAKE, "episodes": 6, "max_episode_steps": 5, **function}
    part = qtab.train(**short, callback=[KeepBest(path, 1, 2, seed=7), lambda now: now.episodes < 4], callback_every=4)
    best = KeepBest(path, 1, 2, seed=7)
    qtab.resume(part, callback=best)
    assert best.run is not None
    assert len(best.run.episode_returns) == 2  # all evaluations are equal, and the first is kept
    assert best.run.config == part.config


def test_the_table_of_another_run_with_the_same_returns_is_not_kept(tmp_path):
    path, short = tmp_path / "best.npz", {**LAKE, "episodes": 6, "max_episode_steps": 2}  # too few to reach the goal
    qtab.train(**short, learning_rate=0.7, callback=KeepBest(path, 1, 2))
    part = qtab.train(**short, learning_rate=0.3, callback=lambda now: now.episodes < 4, callback_every=4)
    best = KeepBest(path, 1, 2)
    qtab.resume(part, callback=best)
    assert best.run is not None
    assert best.run.config.learning_rate == 0.3
    assert qtab.load(path).config.learning_rate == 0.3


def test_of_equal_evaluations_the_first_is_kept():
    best = KeepBest(episodes=1, every=2)
    qtab.train("MountainCar-v0", episodes=6, max_episode_steps=5, callback=best)
    assert best.run is not None
    assert len(best.run.episode_returns) == 2


def test_a_run_stops_when_its_last_returns_are_good_enough():
    stop = StopAtReturn(-110, window=100, every=10)
    run = qtab.train("MountainCar-v0", preset="solved", seed=0, callback=stop)
    episodes = len(run.episode_returns)
    assert run.completed is False
    assert stop.stopped_at == episodes
    assert episodes % 10 == 0
    assert run.episode_returns[-100:].mean() >= -110
    for earlier in range(100, episodes, 10):
        assert run.episode_returns[earlier - 100 : earlier].mean() < -110


def test_a_run_does_not_stop_before_it_has_a_whole_window():
    stop = StopAtReturn(-1e9, window=8)
    assert len(qtab.train("MountainCar-v0", episodes=10, callback=stop, callback_every=3).episode_returns) == 9
    stop = StopAtReturn(-1e9, window=11)
    assert qtab.train("MountainCar-v0", episodes=10, callback=stop, callback_every=1).completed
    assert stop.stopped_at is None


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"episodes": 0}, r"^episodes must be an integer of at least 1, got 0$"),
        ({"seed": -1}, r"^seed must be an integer of at least 0, got -1$"),
        ({"env": "FrozenLake-v1"}, r"^env must be an environment, got 'FrozenLake-v1'$"),
        ({"every": 0}, r"^every must be an integer of at least 1, got 0$"),
    ],
)
@pytest.mark.parametrize("kind", [EvaluateEvery, KeepBest])
def test_wrong_arguments_are_refused_by_name(kind, arguments, message):
    with pytest.raises((TypeError, ValueError), match=message):
        kind(**arguments)


@pytest.mark.parametrize("make", [EvaluateEvery, KeepBest])
def test_the_object_that_evaluated_the_earlier_part_continues(make):
    short = {**LAKE, "episodes": 1500}
    whole = make(episodes=20, every=250)
    qtab.train(**short, callback=whole)
    half: list[qtab.Run] = []

    def fail(now: qtab.Progress) -> None:
        half.append(now.run)
        if len(half) == 2:
            raise KeyboardInterrupt

    evaluation = make(episodes=20, every=250)
    with pytest.raises(KeyboardInterrupt):
        qtab.train(**short, callback=[evaluation, fail], callback_every=500)
    assert evaluation.evaluated_at == [250, 500, 750, 1000]
    qtab.resume(half[0], callback=evaluation)  # without what was evaluated after it
    assert evaluation.evaluated_at == whole.evaluated_at
    assert evaluation.mean_returns.tobytes() == whole.mean_returns.tobytes()
    if isinstance(whole, KeepBest):
        assert whole.run is not None
        assert evaluation.best_return == whole.best_return
        assert_same_run(evaluation.run, whole.run)


@pytest.mark.parametrize("change", [{"seed": 4}, {"learning_rate": 0.3}, {"episodes": 1000}])
def test_evaluations_of_another_run_are_not_continued(change):
    evaluation = EvaluateEvery(episodes=5, every=100)
    part = qtab.train(**{**LAKE, "episodes": 400}, callback=lambda now: now.episodes < 200, callback_every=200)
    qtab.train(**{**LAKE, "episodes": 400, **change}, callback=evaluation)
    qtab.resume(part, callback=evaluation)
    assert evaluation.evaluated_at == [300, 400]


def test_a_logger_writes_no_evaluation_twice_where_a_run_is_resumed(tmp_path):
    evaluation, path = EvaluateEvery(episodes=5, every=200), tmp_path / "log.csv"
    callback: list[Any] = [evaluation, CSVLogger(path, every=50, metrics=["steps"], evaluation=evaluation)]
    short = {**LAKE, "episodes": 400}
    part = qtab.train(**short, callback=[*callback, lambda now: now.episodes < 250], callback_every=250)
    qtab.resume(part, callback=callback)
    lines = path.read_text(encoding="utf-8").splitlines()[1:]
    evaluated = [int(line.split(",")[0]) for line in lines if not line.endswith(",")]
    assert evaluation.evaluated_at == [200, 250, 400]
    assert evaluated == [200, 400]  # the one at the stop came after the line of the same episode
