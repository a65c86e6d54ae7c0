"""The time per step of the learners on MountainCar-v0, and of the book's bandits, prediction and control."""

from typing import Any

import numpy as np

import qtab
from loops import numba_loops
from loops.numba_loops import TILES, TILINGS
from qtab.book.testbed import GREEDY, SAMPLE_AVERAGES, run_testbeds
from qtab.prediction.estimate import estimate_values
from tables import Benchmark, Column, Table, relative_time, relative_to

CUTOFF = 1e-3
_TILES: dict[str, Any] = {"discretizer": "tiles", "tilings": TILINGS, "tiles": TILES, "episodes": 500}
_TILES |= {"learning_rate": 0.3, "discount": 1.0, "epsilon": 0.0, "initial_q": 0.0}
_TRACES = {**_TILES, "algorithm": "sarsa_lambda", "trace_decay": 0.9}

Q_LEARNING = "Q-learning, the article's grid"
TRACES, CUT = "Sarsa(0.9), 8 tilings", "Sarsa(0.9), 8 tilings, trace_cutoff=1e-3"
LEARNERS: dict[str, dict[str, Any]] = {
    Q_LEARNING: {},
    "Sarsa, the same grid": {"algorithm": "sarsa"},
    "Expected Sarsa, the same grid": {"algorithm": "expected_sarsa"},
    "Q-learning, 8 tilings": _TILES,
    "Sarsa, 8 tilings": {**_TILES, "algorithm": "sarsa"},
    TRACES: _TRACES,
    CUT: {**_TRACES, "trace_cutoff": CUTOFF},
}
IN_BATCHES = ("Q-learning, 8 tilings", "Sarsa, 8 tilings")
NUMBA = {TRACES: f"{TRACES}, under numba", CUT: f"{CUT}, under numba"}

BANDIT = "ε-greedy, 10-armed bandit"
PROBLEMS, STEPS = 500, 1000
BANDITS: dict[str, dict[str, Any]] = {
    BANDIT: {**GREEDY, **SAMPLE_AVERAGES, "epsilon": 0.1},
    "UCB, 10-armed bandit": {**SAMPLE_AVERAGES, "initial_q": 0.0, "exploration": "ucb", "ties": "random"},
    "gradient bandit, 10 arms": {"algorithm": "gradient_bandit", "learning_rate": 0.1, "initial_q": 0.0},
}
WALK, WALK_ENV = "Q-learning, 19-state random walk", "qtab/RandomWalk-v0"
EPISODES = 5000
"""How many episodes of the walk and of the cliff are timed."""
WALK_STEPS = 100
"""The mean number of steps of an episode of the walk: the product of the distances to both ends."""
MAX_WALK_STEPS = 10_000
PREDICTION: dict[str, dict[str, Any]] = {
    "TD(0), 19-state random walk": {"method": "td"},
    "4-step TD, the same walk": {"method": "n_step_td", "n_steps": 4},
    "TD(0.8), the same walk": {"method": "td_lambda", "trace_decay": 0.8},
    "Monte Carlo prediction, the same walk": {"method": "monte_carlo"},
}
CLIFF = "Q-learning, CliffWalking-v1"
CONTROL: dict[str, dict[str, Any]] = {
    CLIFF: {"algorithm": "q_learning"},
    "on-policy Monte Carlo, the same cliff": {"algorithm": "monte_carlo"},
    "4-step tree backup, the same cliff": {"algorithm": "n_step_tree_backup", "n_steps": 4},
    "4-step Q(σ), the same cliff": {"algorithm": "n_step_q_sigma", "n_steps": 4},
    "prioritized sweeping, 5 updates, the same cliff": {"algorithm": "prioritized_sweeping", "planning_steps": 5},
    "REINFORCE, the same cliff": {"algorithm": "reinforce"},
    "actor-critic, the same cliff": {"algorithm": "actor_critic"},
}


def learners() -> Table:
    """Returns the table of the learners: single runs, some in batches, and Numba's loops if Numba is installed."""
    loops = {name: _single("MountainCar-v0", settings) for name, settings in LEARNERS.items()}
    loops |= {f"{name}, train_many, 16 seeds, one thread": _many(LEARNERS[name]) for name in IN_BATCHES}
    if numba_loops.numba:
        loops |= {NUMBA[TRACES]: _sarsa_lambda(0.0), NUMBA[CUT]: _sarsa_lambda(CUTOFF)}
    columns = [Column("rel. time", relative_to(Q_LEARNING, [*loops]), relative_time), Column("× numba", NUMBA)]
    return Table("Learners on MountainCar-v0", loops, columns)


def book() -> Table:
    """Returns the table of the book's chapters, each group relative to its first row."""
    bandits = {name: _bandit(config) for name, config in BANDITS.items()}
    # Random actions, so that the episodes are those of the random policy.
    walk = {**GREEDY, "epsilon": 1.0, "discount": 1.0, "learning_rate": 0.1, "episodes": EPISODES}
    walks = {WALK: _single(WALK_ENV, {**walk, "max_episode_steps": MAX_WALK_STEPS})}
    walks |= {name: _prediction(options) for name, options in PREDICTION.items()}
    shared = {"episodes": EPISODES, "max_episode_steps": 200, "initial_q": 0.0, "discount": 1.0}
    cliffs = {name: _single("CliffWalking-v1", {**shared, **config}) for name, config in CONTROL.items()}
    bases = relative_to(BANDIT, [*bandits]) | relative_to(WALK, [*walks]) | relative_to(CLIFF, [*cliffs])
    columns = [Column("rel. time", bases, relative_time)]
    return Table("Bandits, prediction and control, one thread", bandits | walks | cliffs, columns)


def _single(env: str, settings: dict[str, Any]) -> Benchmark:
    return lambda index: int(qtab.train(env, seed=index, progress=False, **settings).episode_lengths.sum())


def _many(settings: dict[str, Any]) -> Benchmark:
    return lambda _: int(
        qtab.train_many("MountainCar-v0", 16, threads=1, progress=False, **settings).episode_lengths.sum()
    )


def _sarsa_lambda(cutoff: float) -> Benchmark:
    def run(seed: int) -> int:
        starts = np.random.default_rng(seed).uniform(-0.6, -0.4, _TILES["episodes"])
        return int(numba_loops.sarsa_lambda(starts, seed, cutoff)[2])

    return run


def _bandit(config: dict[str, Any]) -> Benchmark:
    settings = {"max_episode_steps": 1, "episodes": STEPS, **config}

    def choose(index: int) -> int:
        rewards, _ = run_testbeds(settings, range(index * PROBLEMS, (index + 1) * PROBLEMS), 1)
        return rewards.size

    return choose


def _prediction(options: dict[str, Any]) -> Benchmark:
    settings = {"learning_rate": 0.1, "episodes": EPISODES, "record": EPISODES, "threads": 1, **options}

    def estimate(index: int) -> int:
        estimate_values(WALK_ENV, "random", seeds=[index], max_episode_steps=MAX_WALK_STEPS, **settings)
        return EPISODES * WALK_STEPS

    return estimate
