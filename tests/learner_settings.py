"""Random settings of every algorithm, for the tests that hold Rust against plain NumPy."""

from typing import Any

from hypothesis import strategies as st

from qtab.options import ONE_STEP, TABLES_ONLY

share = st.floats(0, 1)
falling = st.sampled_from(["linear", "exponential"])


@st.composite
def learning_rates(draw: st.DrawFn, most: float, by_visits: bool) -> dict[str, Any]:
    rate = draw(st.floats(0, most))
    kinds = ["constant", "linear", "exponential"] + ["visits"] * by_visits
    kind = draw(st.sampled_from(kinds))
    settings: dict[str, Any] = {"learning_rate": rate, "learning_rate_schedule": kind}
    if kind != "constant":
        settings["min_learning_rate"] = draw(st.floats(0, rate))
    if kind in ("linear", "exponential"):
        settings["learning_rate_warm_up"] = draw(st.integers(0, 3))
    if kind == "exponential":
        settings["learning_rate_decay"] = draw(share)
    return settings


@st.composite
def explorations(draw: st.DrawFn) -> dict[str, Any]:
    if draw(st.booleans()):
        return {"exploration": "softmax", "temperature": draw(st.floats(0.01, 100))}
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
def features(draw: st.DrawFn, algorithm: str) -> dict[str, Any]:
    if algorithm in TABLES_ONLY or draw(st.booleans()):
        settings: dict[str, Any] = {"scale": draw(st.sampled_from([(10, 100), (3, 20.5), (0.1, 0.1)]))}
        if algorithm in ONE_STEP:
            settings["terminal_update"] = draw(st.sampled_from(["assign", "target"]))
        return settings
    return {
        "discretizer": "tiles",
        "tilings": draw(st.integers(1, 9)),
        "tiles": draw(st.tuples(st.integers(1, 9), st.integers(1, 9))),
        "hashed_rows": draw(st.sampled_from([None, None, 1, 20, 1000])),
        "low": draw(st.sampled_from([None, (-1.2, -0.07)])),
        "high": draw(st.sampled_from([None, (0.5, 0.07)])),
    }


def own_options(algorithm: str) -> st.SearchStrategy[dict[str, Any]]:
    traced = {"trace_decay": share, "trace_cutoff": st.sampled_from([0.0, 1e-3, 0.3])}
    kinds = st.sampled_from(["accumulating", "replacing", "clearing"])
    options: dict[str, dict[str, st.SearchStrategy[Any]]] = {
        "n_step_sarsa": {"n_steps": st.integers(1, 60)},
        "sarsa_lambda": {**traced, "traces": kinds},
        "watkins_q_lambda": {**traced, "traces": kinds},
        "true_online_sarsa_lambda": traced,
        "dyna_q": {"planning_steps": st.integers(0, 5)},
        "dyna_q_plus": {"planning_steps": st.integers(0, 5), "time_weight": st.floats(0, 1)},
    }
    return st.fixed_dictionaries(options.get(algorithm, {}))


@st.composite
def run_settings(draw: st.DrawFn, algorithm: str) -> dict[str, Any]:
    """Settings of a short run of MountainCar."""
    settings = draw(features(algorithm))
    # Full steps of tile coding may diverge, which is another test's.
    most = 0.5 if "tiles" in settings else 1.0
    return {
        **settings,
        **draw(learning_rates(most, by_visits=algorithm != "true_online_sarsa_lambda")),
        **draw(explorations()),
        **draw(own_options(algorithm)),
        "algorithm": algorithm,
        "discount": draw(st.floats(0, 1)),
        "initial_q": draw(st.sampled_from([0.0, 1.5, (-1.0, 1.0), (-0.001, 0.0)])),
        "on_truncation": draw(st.sampled_from(["bootstrap", "terminate"])),
        "bit_generator": draw(st.sampled_from(["PCG64", "MT19937"])),
        "max_episode_steps": draw(st.sampled_from([1, 7, 40])),
        "seed": draw(st.integers(0, 2**32 - 1)),
        "episodes": draw(st.integers(4, 8)),
    }
