"""Example 8.4: prioritized sweeping against Dyna-Q on mazes of eight sizes."""

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import gymnasium as gym
import numpy as np

from qtab import _core
from qtab._utils.progress import ProgressBar
from qtab.book.experiment import Experiment, Outcome
from qtab.book.line import Line, LineStyle, line_from_samples
from qtab.book.result import aligned
from qtab.book.runner import FloatArray
from qtab.envs.book.mazes import MOST_DOUBLINGS, DynaMazeEnv
from qtab.training.setup.resolve import resolve

ENV = "qtab/DynaMaze-v0"
PLANNING_STEPS = 5
EPISODES = 20_000
"""The largest number of episodes. If a run has not found a shortest path by then, exploration hardly ever will."""
PRECISION = 1.02
"""The factor between the numbers of updates at two checks of the greedy policy: checks cost more than learning."""
METHODS = {"Dyna-Q": "dyna_q", "prioritized sweeping": "prioritized_sweeping"}
"""The algorithm of each line."""
CONFIG: dict[str, Any] = {
    "planning_steps": PLANNING_STEPS,
    "learning_rate": 1.0,
    "discount": 0.95,
    "epsilon": 0.1,
    "epsilon_schedule": "constant",
    "ties": "random",
    "initial_q": 0.0,
    "max_episode_steps": 10_000_000,
    "episodes": EPISODES,
}
"""The keyword arguments of :func:`qtab.train`."""


class Maze:
    """A maze that checks whether a table solves it."""

    def __init__(self, doublings: int) -> None:
        self.doublings = doublings
        env: Any = gym.make(ENV, doublings=doublings).unwrapped
        assert isinstance(env, DynaMazeEnv)  # noqa: S101 - the class behind the id
        self.states = sum(row.count(".") + row.count("S") + row.count("G") for row in env.layout)
        self.start = int(np.argmax(env.initial_state_distrib))
        self.next_states = np.array(
            [[env.P[state][action][0][1] for action in range(4)] for state in range(len(env.P))]
        )
        self.is_goal = np.array([cell == "G" for row in env.layout for cell in row])
        self.shortest = self._shortest()
        self._specs: dict[str, Any] = {}

    def _shortest(self) -> int:
        """Returns the number of steps of the shortest path, by breadth-first search."""
        reached = np.zeros(len(self.is_goal), np.bool_)
        reached[self.start] = True
        steps = 0
        while not (reached & self.is_goal).any():
            reached[self.next_states[reached].ravel()] = True
            steps += 1
        return steps

    def spec(self, algorithm: str) -> Any:
        """Returns the run spec of an algorithm in the maze; its seed is not used."""
        if algorithm not in self._specs:
            options = {**CONFIG, "algorithm": algorithm, "env_kwargs": {"doublings": self.doublings}, "seed": 0}
            self._specs[algorithm] = resolve(ENV, options).spec()
        return self._specs[algorithm]

    def is_solved(self, table: FloatArray) -> bool:
        """Returns whether the greedy policy, which takes the first of several best actions, takes a shortest path."""
        state, greedy = self.start, table.reshape(-1, 4).argmax(axis=1)
        for _ in range(self.shortest):
            state = int(self.next_states[state, greedy[state]])
        return bool(self.is_goal[state])


def updates_to_optimum(maze: Maze, algorithm: str, seed: int) -> tuple[int, bool]:
    """Returns the number of updates, to within 2 %, until the greedy policy is optimal, and whether it ever was.

    If not, exploration has not found a shortest path in ``EPISODES`` episodes, and all updates are counted.
    """
    trainer = _core.Trainer(maze.spec(algorithm), seed)
    updates, steps, seen = 0, 0, 0
    for episode in range(1, EPISODES + 1):
        trainer.advance(episode)
        before, planned = updates, trainer.planning_updates()
        steps += int(trainer.episodes(episode - 1)[1][0])
        # Each step of Dyna-Q makes a direct update and all planning updates.
        updates = steps * (1 + PLANNING_STEPS) if planned is None else planned
        # The queue of prioritized sweeping can be empty for thousands of episodes, in which the policy does not change.
        rests = updates == before != seen
        if updates >= PRECISION * seen > 0 or rests or episode == 1:
            if maze.is_solved(trainer.tables()):
                return updates, True
            seen = updates
    return updates, False


class UpdatesToOptimum(Experiment):
    """The number of updates that each method needs on each maze."""

    def _run(self, runs: int, seed: int, threads: int, progress: bool | None) -> Outcome:
        """Runs both methods on every maze with every seed."""
        mazes = [Maze(doublings) for doublings in range(MOST_DOUBLINGS + 1)]
        tasks = [(name, maze, seed + number) for maze in mazes for name in METHODS for number in range(runs)]
        missed = dict.fromkeys(((name, maze.states) for maze in mazes for name in METHODS), 0)
        counts: dict[tuple[str, int], list[int]] = {(name, maze.states): [] for maze in mazes for name in METHODS}
        with ProgressBar(len(tasks), "run", progress, self.name) as bar, ThreadPoolExecutor(threads) as pool:
            done = pool.map(lambda task: updates_to_optimum(task[1], METHODS[task[0]], task[2]), tasks)
            for index, ((name, maze, _), (count, is_optimal)) in enumerate(zip(tasks, done, strict=True)):
                counts[name, maze.states].append(count)
                missed[name, maze.states] += not is_optimal
                bar.move_to(index + 1)
        sizes = np.array([maze.states for maze in mazes], np.float64)
        lines = []
        for name, algorithm in METHODS.items():
            samples = np.array([counts[name, maze.states] for maze in mazes], np.float64).T
            style = LineStyle(method=algorithm if name == "Dyna-Q" else "")
            lines.append(line_from_samples(name, sizes, samples, style=style))
        return Outcome(lines, table=_table(lines, missed))


def _table(lines: Sequence[Line], missed: Mapping[tuple[str, int], int]) -> str:
    """Returns the numbers of updates, and of the runs that never became optimal, which count with all their updates."""
    rows = [["", "states", "updates", "std. error", "never optimal"]]
    for line in lines:
        for states, mean, error in zip(line.x.tolist(), line.mean, line.error, strict=True):
            rows.append(
                [line.name, f"{states:,.0f}", f"{mean:,.0f}", f"{error:,.0f}", str(missed[line.name, int(states)])]
            )
    return "\n".join(aligned(rows))


EXPERIMENT = UpdatesToOptimum(
    name="example-8.4",
    title="prioritized sweeping and Dyna-Q on mazes",
    book=f"mazes of the same structure with more and more cells; at most n = {PLANNING_STEPS} updates per step",
    unspecified="all other settings: here α = 1, ε = 0.1, γ = 0.95, θ = 0.0001, ties are broken at random, and there "
    "are 10 runs. The greedy policy is checked between episodes, after every 2 % more updates; it is optimal if it "
    "takes a shortest path. A run that takes none after 20,000 episodes counts with all of its updates. The update "
    "that Dyna-Q makes from each real step counts",
    runs=10,
    names=tuple(METHODS),
    x_label="number of states",
    y_label="updates until the policy is optimal",
    log_x=True,
    x_ticks=(47, 94, 188, 376, 752, 1504, 3008, 6016),
    log_y=True,
)
