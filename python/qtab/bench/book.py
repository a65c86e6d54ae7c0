"""The time per step of what the book's chapters add to the learners: bandits, prediction, and control on a table."""

from typing import Any

from qtab.bench.timing import Benchmark, Timings
from qtab.book.testbed import GREEDY, SAMPLE_AVERAGES, run_testbeds
from qtab.prediction.estimate import estimate_values
from qtab.prediction.settings import Method
from qtab.training.train import train

TITLE = "Bandits, prediction and control, one thread"

BANDIT = "ε-greedy, 10-armed bandit"
PROBLEMS, STEPS = 500, 1000
_UCB = {**SAMPLE_AVERAGES, "initial_q": 0.0, "exploration": "ucb", "ties": "random"}
_BANDITS: dict[str, dict[str, Any]] = {
    BANDIT: {**GREEDY, **SAMPLE_AVERAGES, "epsilon": 0.1},
    "UCB, 10-armed bandit": _UCB,
    "gradient bandit, 10 arms": {"algorithm": "gradient_bandit", "learning_rate": 0.1, "initial_q": 0.0},
}

WALK = "Q-learning, 19-state random walk"
_WALK = "qtab/RandomWalk-v0"
EPISODES = 5000
"""How many episodes of the walk and of the cliff are timed."""
MAX_EPISODE_STEPS = 10_000
WALK_STEPS = 100
"""The mean number of steps of an episode of the walk: the product of the distances to both ends."""
_METHODS: dict[str, tuple[Method, dict[str, Any]]] = {
    "TD(0), 19-state random walk": ("td", {}),
    "4-step TD, the same walk": ("n_step_td", {"n_steps": 4}),
    "TD(0.8), the same walk": ("td_lambda", {"trace_decay": 0.8}),
    "Monte Carlo prediction, the same walk": ("monte_carlo", {}),
}

CLIFF = "Q-learning, CliffWalking-v1"
_CONTROL: dict[str, dict[str, Any]] = {
    CLIFF: {"algorithm": "q_learning"},
    "on-policy Monte Carlo, the same cliff": {"algorithm": "monte_carlo"},
    "4-step tree backup, the same cliff": {"algorithm": "n_step_tree_backup", "n_steps": 4},
    "4-step Q(σ), the same cliff": {"algorithm": "n_step_q_sigma", "n_steps": 4},
    "prioritized sweeping, 5 updates, the same cliff": {"algorithm": "prioritized_sweeping", "planning_steps": 5},
    "REINFORCE, the same cliff": {"algorithm": "reinforce"},
    "actor-critic, the same cliff": {"algorithm": "actor_critic"},
}

GROUPS = ((BANDIT, tuple(_BANDITS)), (WALK, (WALK, *_METHODS)), (CLIFF, tuple(_CONTROL)))
"""The benchmarks that are compared with each other; the first of a group is what the others are relative to."""


def training() -> dict[str, Benchmark]:
    """Returns the benchmarks."""
    bandits = {name: _bandit(config) for name, config in _BANDITS.items()}
    methods = {name: _prediction(method, options) for name, (method, options) in _METHODS.items()}
    return {**bandits, WALK: _walk, **methods, **{name: _control(config) for name, config in _CONTROL.items()}}


def lines(timings: Timings) -> list[list[str]]:
    """Returns the rows of the table: name, nanoseconds per step, and time relative to the first of its group."""
    return [
        [name, f"{timings.median(name):,.1f}", f"{timings.ratio(name, first):.2f}"]
        for first, names in GROUPS
        for name in names
    ]


def _bandit(config: dict[str, Any]) -> Benchmark:
    whole = {"max_episode_steps": 1, "episodes": STEPS, **config}

    def choose(index: int) -> int:
        rewards, _ = run_testbeds(whole, range(index * PROBLEMS, (index + 1) * PROBLEMS), 1)
        return rewards.size

    return choose


def _walk(index: int) -> int:
    # Random actions, so that the episodes are those of the random policy.
    settings = {**GREEDY, "epsilon": 1.0, "discount": 1.0, "learning_rate": 0.1, "episodes": EPISODES}
    run = train(_WALK, seed=index, progress=False, **{**settings, "max_episode_steps": MAX_EPISODE_STEPS})
    return int(run.episode_lengths.sum())


def _prediction(method: Method, options: dict[str, Any]) -> Benchmark:
    def estimate(index: int) -> int:
        estimate_values(
            _WALK,
            "random",
            method=method,
            learning_rate=0.1,
            episodes=EPISODES,
            record=EPISODES,
            seeds=[index],
            max_episode_steps=MAX_EPISODE_STEPS,
            threads=1,
            **options,
        )
        return EPISODES * WALK_STEPS

    return estimate


def _control(config: dict[str, Any]) -> Benchmark:
    settings = {"episodes": EPISODES, "max_episode_steps": 200, "initial_q": 0.0, "discount": 1.0, **config}
    return lambda index: int(train("CliffWalking-v1", seed=index, progress=False, **settings).episode_lengths.sum())
