"""Right and wrong calls of the public functions, for type checkers; nothing here is run.

Each wrong line ignores the error that mypy and the one that pyright report; an ignored error that they do not report is
an error itself.
"""

from pathlib import Path

import gymnasium as gym
import numpy as np
import pandas as pd
from typing_extensions import assert_type

import qtab


class Counter(qtab.FunctionalEnv):
    """An environment of one's own."""

    observation_space = gym.spaces.Discrete(10)
    action_space = gym.spaces.Discrete(2)

    def initial_state(self, rng: np.random.Generator) -> int:
        return int(rng.integers(0, 5))

    def transition(self, state: int, action: int, rng: np.random.Generator) -> tuple[int, float, bool]:
        return state + action, -1.0, state + action == 9

    def observe(self, state: int) -> int:
        return state

    def action_mask(self, state: int) -> list[bool]:
        return [True, state < 9]


def right_calls(run: qtab.Run, env: gym.Env) -> None:
    run = qtab.train(Counter(), backend="numba", action_mask=True)
    run = qtab.train(gym.wrappers.TimeLimit(Counter(render_mode=None), 100), backend="python")
    run = qtab.train("MountainCar-v0")
    run = qtab.train("MountainCar-v0", learning_rate=0.1, algorithm="sarsa_lambda", trace_decay=0.9, seed=0)
    run = qtab.train(env, learning_rate=1, tiles=4, low=[-1, -1], high=np.array([1.0, 1.0]), discretizer="tiles")
    run = qtab.train(gym.spec("MountainCar-v0"), learning_rate=np.float32(0.1), seed=np.int64(3), epsilon=None)
    run = qtab.train("Pendulum-v1", actions=3, initial_q=(-1, 1), edges=[[0.0], [0.0, 1.0], np.zeros(1)])
    run = qtab.train("Taxi-v4", initial_q=np.zeros((500, 6)), env_kwargs={"fickle_passenger": True}, preset="solved")
    run = qtab.train("Taxi-v4", action_mask=lambda state: [state > 0] * 6)
    run = qtab.train("Taxi-v4", action_mask=True)
    run.predict(0, action_masks=np.ones(6, np.int8))
    assert_type(run.to_pandas(), pd.DataFrame)
    run = qtab.train(config=run.config, episodes=10)
    run = qtab.train("MountainCar-v0", config={"learning_rate": 0.1}, callback=stop_soon, record=1)
    run = qtab.train("MountainCar-v0", **qtab.presets("MountainCar-v0")["solved"])
    run = qtab.train("MountainCar-v0", callback=[stop_soon, qtab.callbacks.StopAtReturn(-110), print])
    run = qtab.train("MountainCar-v0", resume="run.npz", episodes=10_000)
    run = qtab.train(resume=run, callback=print)
    run = qtab.resume(Path("run.npz"), 10_000, snapshots=5)
    table: np.ndarray = qtab.callbacks.EvaluateEvery(episodes=3).mean_returns
    runs: qtab.Runs = qtab.train_many("MountainCar-v0", callback=stop_later, progress=False)
    runs = qtab.train_many("MountainCar-v0", 100, threads=2, learning_rate=0.1, traces=None)
    runs.save(Path("runs.npz"))
    runs = qtab.load_runs("runs.npz")
    runs = qtab.train_many(lambda: env, range(3), bins=(3, 4), discretizer="bins")
    sweep: qtab.Sweep = qtab.sweep("MountainCar-v0", {"epsilon": [0.1, 0.2]}, store=Path("a.db"), n_steps=2)
    playback: qtab.Playback = qtab.play(run, 3, seed=0, window=False, fps=10)
    animation: qtab.Animation = qtab.animate(run, "learning.gif", what="policy")
    run.to_html(Path("run.html"), optimum=-97.7, env=env)
    evaluation: qtab.Evaluation = qtab.evaluate(run, 10, seed=0, max_episode_steps=1000)
    config: qtab.Config = run.config.replace(env="Taxi-v4", learning_rate=0.5, tiles=None)
    config = qtab.Config("Taxi-v4", tiles=8, discretizer="tiles", scale=[])
    tabulated: qtab.TabulatedEnv = qtab.tabulate(env, max_states=1000)
    tabular: qtab.TabularEnv = tabulated
    del tabulated, tabular, table, runs, sweep, playback, animation, evaluation, config


def stop_soon(progress: qtab.Progress) -> bool:
    return progress.episodes < 10 and bool(progress.returns.mean() < 0) and progress.run.q_table.size > 0


def stop_later(progress: qtab.RunsProgress) -> bool:
    return progress.runs < 10 and bool(progress.returns.mean() < 0) and len(progress.finished) > 0


def wrong_calls(run: qtab.Run, progress: qtab.Progress) -> None:
    qtab.train("MountainCar-v0", learnig_rate=0.1)  # type: ignore[call-arg]  # pyright: ignore[reportCallIssue]
    qtab.train("MountainCar-v0", algorithm="qlearning")  # type: ignore[arg-type]  # pyright: ignore[reportArgumentType]
    qtab.train("MountainCar-v0", learning_rate="fast")  # type: ignore[arg-type]  # pyright: ignore[reportArgumentType]
    qtab.train("MountainCar-v0", learning_rate=None)  # type: ignore[arg-type]  # pyright: ignore[reportArgumentType]
    qtab.train("MountainCar-v0", episodes=1e3)  # type: ignore[arg-type]  # pyright: ignore[reportArgumentType]
    qtab.train("Taxi-v4", action_mask="info")  # type: ignore[arg-type]  # pyright: ignore[reportArgumentType]
    qtab.train("MountainCar-v0", scale="10")  # type: ignore[arg-type]  # pyright: ignore[reportArgumentType]
    qtab.train("MountainCar-v0", callback=3)  # type: ignore[arg-type]  # pyright: ignore[reportArgumentType]
    qtab.train("MountainCar-v0", callback=[3])  # type: ignore[list-item]  # pyright: ignore[reportArgumentType]
    qtab.train("MountainCar-v0", resume=3)  # type: ignore[arg-type]  # pyright: ignore[reportArgumentType]
    qtab.train("MountainCar-v0", callback=stop_later)  # type: ignore[arg-type]  # pyright: ignore[reportArgumentType]
    qtab.train_many("Taxi-v4", callback=stop_soon)  # type: ignore[arg-type]  # pyright: ignore[reportArgumentType]
    qtab.callbacks.Checkpoint(3)  # type: ignore[arg-type]  # pyright: ignore[reportArgumentType]
    qtab.load_runs(3)  # type: ignore[arg-type]  # pyright: ignore[reportArgumentType]
    del qtab.load("runs.npz").seeds  # type: ignore[attr-defined]  # pyright: ignore[reportAttributeAccessIssue]
    qtab.train_many("Taxi-v4", learnig_rate=0.1)  # type: ignore[call-arg]  # pyright: ignore[reportCallIssue]
    qtab.train_many("Taxi-v4", algorithm="qlearning")  # type: ignore[arg-type]  # pyright: ignore[reportArgumentType]
    qtab.train_many("Taxi-v4", learning_rate="fast")  # type: ignore[arg-type]  # pyright: ignore[reportArgumentType]
    qtab.train_many("Taxi-v4", seed=0)  # type: ignore[call-arg]  # pyright: ignore[reportCallIssue]
    qtab.sweep("Taxi-v4", [], learnig_rate=0.1)  # type: ignore[call-arg]  # pyright: ignore[reportCallIssue]
    qtab.sweep("Taxi-v4", [], algorithm="qlearning")  # type: ignore[arg-type]  # pyright: ignore[reportArgumentType]
    qtab.sweep("Taxi-v4", [], learning_rate="fast")  # type: ignore[arg-type]  # pyright: ignore[reportArgumentType]
    qtab.evaluate(run, learnig_rate=0.1)  # type: ignore[call-arg]  # pyright: ignore[reportCallIssue]
    qtab.evaluate(run, algorithm="qlearning")  # type: ignore[call-arg]  # pyright: ignore[reportCallIssue]
    qtab.evaluate(run, max_episode_steps="many")  # type: ignore[arg-type]  # pyright: ignore[reportArgumentType]
    qtab.play(run, epsiodes=2)  # type: ignore[call-arg]  # pyright: ignore[reportCallIssue]
    qtab.play(run, window="yes")  # type: ignore[arg-type]  # pyright: ignore[reportArgumentType]
    qtab.animate(run, what="value")  # type: ignore[arg-type]  # pyright: ignore[reportArgumentType]
    run.to_html()  # type: ignore[call-arg]  # pyright: ignore[reportCallIssue]
    run.config.replace(learnig_rate=0.1)  # type: ignore[call-arg]  # pyright: ignore[reportCallIssue]
    run.config.replace(discretizer="hexagons")  # type: ignore[arg-type]  # pyright: ignore[reportArgumentType]
    qtab.Config(learnig_rate=0.1)  # type: ignore[call-arg]  # pyright: ignore[reportCallIssue]
    qtab.Config("Taxi-v4", ties="last")  # type: ignore[arg-type]  # pyright: ignore[reportArgumentType]
    del progress.rewards  # type: ignore[attr-defined]  # pyright: ignore[reportAttributeAccessIssue]
    qtab.trian("Taxi-v4")  # type: ignore[attr-defined]  # pyright: ignore[reportAttributeAccessIssue]
