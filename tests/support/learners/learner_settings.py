"""Random settings of every algorithm, for the tests that compare Rust with NumPy."""

from collections.abc import Sequence
from typing import Any

import pytest
from hypothesis import strategies as st

from qtab import _core
from qtab.config.options import ONE_STEP, PREFERENCES, TABLES_ONLY, WITH_PROBABILITIES, fixed_settings
from qtab.envs.registry import ENTRIES
from support.processes.machine import MACHINE

CAR = "MountainCar-v0"
LIMITS: dict[str, tuple[tuple[float, ...], tuple[float, ...]]] = {
    CAR: ((-1.2, -0.07), (0.6, 0.07)),
    "MountainCarContinuous-v0": ((-1.2, -0.07), (0.6, 0.07)),
    "CartPole-v1": ((-2.4, -3.0, -0.21, -3.5), (2.4, 3.0, 0.21, 3.5)),
    "Acrobot-v1": ((-1.0, -1.0, -1.0, -1.0, -12.0, -28.0), (1.0, 1.0, 1.0, 1.0, 12.0, 28.0)),
    "Pendulum-v1": ((-1.0, -1.0, -8.0), (1.0, 1.0, 8.0)),
}
"""For each environment, limits of its observations."""
SCALES: dict[str, list[Any]] = {
    CAR: [(10, 100), (3, 20.5), (0.1, 0.1)],
    "Acrobot-v1": [(1, 2, 1, 1, 0.1, 0.07)],
    "Pendulum-v1": [(4, 3, 1)],
}
SCALES["MountainCarContinuous-v0"] = SCALES[CAR]
KEYWORDS: dict[str, tuple[str, list[Any]]] = {
    CAR: ("goal_velocity", [0, 0.02]),
    "MountainCarContinuous-v0": ("goal_velocity", [0, 0.02]),
    "CartPole-v1": ("sutton_barto_reward", [False, True]),
    "Pendulum-v1": ("g", [10.0, 9.81, 0]),
}
TRAINED = [
    pytest.param(
        env,
        marks=[
            pytest.mark.skipif(
                not _core.matches_numpy(ENTRIES[env].name), reason=f"Rust does not compute as NumPy here: {MACHINE}"
            ),
            *[pytest.mark.slow] * (env != CAR),  # many examples more of what MountainCar shows of each algorithm
        ],
    )
    for env in LIMITS
]
"""The environments that train in Rust on this machine."""
BY_EPISODE = ("true_online_sarsa_lambda", *PREFERENCES)
"""The algorithms whose learning rate cannot fall with the visits."""
share = st.floats(0, 1)
falling = st.sampled_from(["linear", "exponential"])


@st.composite
def learning_rates(draw: st.DrawFn, most: float, by_visits: bool, algorithm: str = "") -> dict[str, Any]:
    rate = draw(st.floats(0, most))
    kinds = ["constant", "linear", "exponential"] + ["visits"] * by_visits
    kind = draw(st.sampled_from(["visits"] if algorithm == "off_policy_monte_carlo" else kinds))
    settings: dict[str, Any] = {"learning_rate": rate, "learning_rate_schedule": kind}
    if kind != "constant":
        settings["min_learning_rate"] = draw(st.floats(0, rate))
    if kind in ("linear", "exponential"):
        settings["learning_rate_warm_up"] = draw(st.integers(0, 3))
    if kind == "exponential":
        settings["learning_rate_decay"] = draw(share)
    return settings


def possible_explorations(algorithm: str, features: dict[str, Any]) -> list[str]:
    """The ways to explore that an algorithm can use with a discretizer."""
    if algorithm in PREFERENCES:
        return ["softmax"]
    return ["epsilon_greedy", "softmax"] + ["ucb"] * (
        features.get("discretizer") != "tiles" and algorithm not in WITH_PROBABILITIES
    )


@st.composite
def explorations(draw: st.DrawFn, choices: Sequence[str]) -> dict[str, Any]:
    chosen = draw(st.sampled_from(choices))
    if chosen == "softmax":
        return {"exploration": chosen, "temperature": draw(st.floats(0.01, 100))}
    if chosen == "ucb":
        ties = draw(st.sampled_from(["first", "random"]))
        return {"exploration": chosen, "confidence": draw(st.floats(0, 100)), "ties": ties}
    epsilon = draw(share)
    kind = draw(st.sampled_from(["constant", "linear", "exponential"]))
    settings: dict[str, Any] = {"epsilon": epsilon, "epsilon_schedule": kind}
    settings["ties"] = draw(st.sampled_from(["first", "random"]))
    if kind != "constant":
        settings["min_epsilon"] = draw(st.floats(0, epsilon))
        settings["epsilon_warm_up"] = draw(st.integers(0, 3))
    if kind == "exponential":
        settings["epsilon_decay"] = draw(share)
    return settings


@st.composite
def features(draw: st.DrawFn, algorithm: str, env: str = CAR) -> dict[str, Any]:
    """A discretizer with its options; the more components, the fewer cells along each."""
    low, high = LIMITS[env]
    number = st.integers(1, {2: 9, 3: 5, 4: 4}.get(len(low), 2))
    counts = st.tuples(*[number] * len(low))
    # CartPole's space is unbounded.
    spanned = {"low": low, "high": draw(st.sampled_from([high, tuple(0.8 * number for number in high)]))}
    limits = st.sampled_from([spanned] if env == "CartPole-v1" else [spanned, {}])
    kinds = ["round"] * (env in SCALES) + ["bins", "edges"] + ["tiles"] * (algorithm not in TABLES_ONLY)
    kind = draw(st.sampled_from(kinds))
    if kind == "tiles":
        hashed = draw(st.sampled_from([None, None, 1, 20, 1000]))
        # Rust has code of its own for 8, 16 and 32 tilings.
        tilings = draw(st.integers(1, 9) | st.sampled_from((8, 16, 32)))
        tiles = {"tilings": tilings, "tiles": draw(counts), "hashed_rows": hashed}
        return {"discretizer": kind, **tiles, **draw(limits)}
    settings: dict[str, Any] = {"discretizer": kind}
    if kind == "round":
        settings["scale"] = draw(st.sampled_from(SCALES[env]))
    elif kind == "bins":
        settings |= {"bins": draw(counts), **draw(limits)}
    else:
        inside = [st.lists(st.floats(*ends), unique=True, max_size=3) for ends in zip(low, high, strict=True)]
        settings["edges"] = tuple(tuple(sorted(row)) for row in draw(st.tuples(*inside)))
    if algorithm in ONE_STEP:
        settings["terminal_update"] = draw(st.sampled_from(["assign", "target"]))
    return settings


@st.composite
def environments(draw: st.DrawFn, env: str) -> dict[str, Any]:
    """Keyword arguments of the environment, and discrete actions where its actions are continuous."""
    settings: dict[str, Any] = {}
    if env in KEYWORDS:
        name, choices = KEYWORDS[env]
        settings["env_kwargs"] = {name: draw(st.sampled_from(choices))}
    if "Pendulum" in env or "Continuous" in env:
        listed = st.lists(st.floats(-1, 1), min_size=1, max_size=4).map(tuple)
        settings["actions"] = draw(st.integers(2, 5) | listed)
    return settings


def own_options(algorithm: str) -> st.SearchStrategy[dict[str, Any]]:
    """The options of an algorithm, and the settings that have a single value for it."""
    traced = {"trace_decay": share, "trace_cutoff": st.sampled_from([0.0, 1e-3, 0.3])}
    kinds = st.sampled_from(["accumulating", "replacing", "clearing"])
    target = st.sampled_from(["greedy", "behavior"])
    options: dict[str, dict[str, st.SearchStrategy[Any]]] = {
        "n_step_sarsa": {"n_steps": st.integers(1, 60)},
        "sarsa_lambda": {**traced, "traces": kinds},
        "watkins_q_lambda": {**traced, "traces": kinds},
        "true_online_sarsa_lambda": traced,
        "dyna_q": {"planning_steps": st.integers(0, 5), "model": st.sampled_from(["deterministic", "stochastic"])},
        "n_step_tree_backup": {"n_steps": st.integers(1, 60), "target_policy": target},
        "n_step_q_sigma": {"n_steps": st.integers(1, 60), "target_policy": target, "sigma": share},
        "prioritized_sweeping": {
            "planning_steps": st.integers(0, 5),
            "priority_threshold": st.sampled_from([0.0, 1e-4, 0.3]),
        },
        "differential_sarsa": {"reward_learning_rate": share},
        "differential_q_learning": {"reward_learning_rate": share},
        "dyna_q_plus": {"planning_steps": st.integers(0, 5), "time_weight": st.floats(0, 1)},
        "gradient_bandit": {"baseline": st.booleans()},
        "reinforce_with_baseline": {"value_learning_rate": share},
        "actor_critic": {"value_learning_rate": share},
        "actor_critic_lambda": {"value_learning_rate": share, "trace_decay": share},
    }
    fixed = {name: st.just(value) for name, value in fixed_settings(algorithm).items()}
    return st.fixed_dictionaries({**options.get(algorithm, {}), **fixed})


@st.composite
def run_settings(draw: st.DrawFn, algorithm: str, env: str = CAR) -> dict[str, Any]:
    """Settings of a short run."""
    settings: dict[str, Any] = {**draw(features(algorithm, env)), **draw(environments(env))}
    # Full steps of tile coding may diverge; another test covers that.
    most = 0.5 if "tiles" in settings else 1.0
    limit = draw(st.sampled_from([1, 7, 40]))
    return {
        **settings,
        **draw(learning_rates(most, by_visits=algorithm not in BY_EPISODE, algorithm=algorithm)),
        **draw(explorations(possible_explorations(algorithm, settings))),
        "discount": draw(st.floats(0, 1)),
        "algorithm": algorithm,
        "initial_q": draw(st.sampled_from([0.0, 1.5, (-1.0, 1.0), (-0.001, 0.0)])),
        "on_truncation": draw(st.sampled_from(["bootstrap", "terminate"])),
        **draw(own_options(algorithm)),
        "bit_generator": draw(st.sampled_from(["PCG64", "MT19937"])),
        "max_episode_steps": limit,
        "seed": draw(st.integers(0, 2**32 - 1)),
        # The reference takes most of the time of a long run: few long episodes, or more short ones.
        "episodes": draw(st.integers(4, 8 if limit < 40 else 5)),
    }
