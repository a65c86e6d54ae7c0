"""Options that do not apply, values out of range, and divergence."""

from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.config.options import OPTIONS, TABLES_ONLY

TILES: dict[str, Any] = {"discretizer": "tiles"}
VALUES: dict[str, Any] = {
    "trace_decay": 0.5,
    "traces": "replacing",
    "trace_cutoff": 0.0,
    "n_steps": 4,
    "sigma": 0.5,
    "target_policy": "greedy",
    "planning_steps": 5,
    "time_weight": 0.1,
    "model": "deterministic",
    "priority_threshold": 0.1,
    "reward_learning_rate": 0.1,
    "baseline": True,
    "value_learning_rate": 0.1,
    "min_learning_rate": 0.0,
    "learning_rate_decay": 0.9,
    "learning_rate_warm_up": 0,
    "epsilon": 0.5,
    "epsilon_schedule": "linear",
    "ties": "first",
    "min_epsilon": 0.0,
    "epsilon_decay": 0.9,
    "epsilon_warm_up": 0,
    "temperature": 1.0,
    "confidence": 2.0,
    "scale": (10, 100),
    "tilings": 8,
    "tiles": (8, 8),
    "hashed_rows": 1000,
    "bins": (9, 9),
    "edges": ((-0.5,), (0.0,)),
    "low": (-1.2, -0.07),
    "high": (0.6, 0.07),
    **{"shape": (19, 15), "order": 3, "coupled": True, "scale_step_sizes": True, "max_rows": 100},
    **{"centers": (4, 4), "width": (1.0, 1.0), "normalized": True, "radius": (1.5, 1.5)},
}


def strangers() -> list[tuple[str, dict[str, Any]]]:
    """Each option with each choice that it does not apply to."""
    choices = {
        "algorithm": ["q_learning", "sarsa_lambda", "n_step_sarsa", "dyna_q", "true_online_sarsa_lambda"],
        "learning_rate_schedule": ["constant", "linear", "visits"],
        "exploration": ["epsilon_greedy", "softmax", "ucb"],
        "epsilon_schedule": ["constant", "linear"],
        "discretizer": ["round", "bins", "edges", "tiles", "fourier", "polynomial", "radial", "coarse"],
    }
    return [
        (name, {option.choice: chosen})
        for name, option in OPTIONS.items()
        for chosen in choices[option.choice]
        if chosen not in option.values
    ]


def test_every_option_has_a_value_here() -> None:
    assert VALUES.keys() == OPTIONS.keys()


@pytest.mark.parametrize(("name", "chosen"), strangers(), ids=str)
def test_an_option_that_does_not_apply_is_refused_by_name(name: str, chosen: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=rf"^{name} applies to .*, not to .*, got "):
        qtab.train("MountainCar-v0", episodes=1, **chosen, **{name: VALUES[name]})


@pytest.mark.parametrize("algorithm", TABLES_ONLY)
def test_a_model_and_returns_need_a_table(algorithm: Any) -> None:
    with pytest.raises(
        ValueError,
        match=rf"^algorithm must be 'q_learning', .* for discretizer 'tiles', got '{algorithm}', which works with",
    ):
        qtab.train("MountainCar-v0", algorithm=algorithm, **TILES)


@pytest.mark.parametrize("settings", [TILES, {"algorithm": "n_step_sarsa"}, {"algorithm": "watkins_q_lambda"}])
def test_terminal_values_can_be_assigned_only_in_one_step_table_learners(settings: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=r"^terminal_update must be 'target' for .*, got 'assign'"):
        qtab.train("MountainCar-v0", terminal_update="assign", **settings)


def test_true_online_sarsa_lambda_refuses_the_visits_schedule() -> None:
    with pytest.raises(
        ValueError, match=r"^learning_rate_schedule must be 'constant', 'linear' or 'exponential' for .*, got 'visits'"
    ):
        qtab.train("MountainCar-v0", algorithm="true_online_sarsa_lambda", learning_rate_schedule="visits")


@pytest.mark.parametrize(
    ("name", "value", "settings"),
    [
        ("learning_rate", 1.01, {}),
        ("learning_rate", 2.01, TILES),
        ("trace_decay", 1.01, {"algorithm": "sarsa_lambda"}),
        ("trace_cutoff", -0.1, {"algorithm": "sarsa_lambda"}),
        ("traces", "dutch", {"algorithm": "sarsa_lambda"}),
        ("n_steps", 0, {"algorithm": "n_step_sarsa"}),
        ("planning_steps", -1, {"algorithm": "dyna_q"}),
        ("time_weight", -1.0, {"algorithm": "dyna_q_plus"}),
        ("sigma", 1.01, {"algorithm": "n_step_q_sigma"}),
        ("target_policy", "behaviour", {"algorithm": "n_step_q_sigma"}),
        ("model", "random", {"algorithm": "dyna_q"}),
        ("priority_threshold", -1.0, {"algorithm": "prioritized_sweeping"}),
        ("reward_learning_rate", 1.5, {"algorithm": "differential_sarsa"}),
        ("count_bonus", -0.1, {}),
        ("time_weight", float("inf"), {"algorithm": "dyna_q_plus"}),
        ("temperature", 0.0, {"exploration": "softmax"}),
        ("temperature", float("nan"), {"exploration": "softmax"}),
        ("epsilon_decay", 1.1, {"epsilon_schedule": "exponential"}),
        ("epsilon_warm_up", 5, {"episodes": 5}),
        ("min_epsilon", 0.6, {"epsilon": 0.5}),
        ("min_epsilon", 0.81, {}),
        ("learning_rate_warm_up", -1, {"learning_rate_schedule": "linear"}),
        ("min_learning_rate", 0.3, {"learning_rate": 0.2, "learning_rate_schedule": "linear"}),
        ("tilings", 0, TILES),
        ("tilings", 33, TILES),
        ("tiles", (8, 0), TILES),
        ("tiles", (8, 8, 8), TILES),
        ("tiles", (), TILES),
        ("tiles", (60_000, 60_000), TILES),
        ("hashed_rows", 0, TILES),
        ("hashed_rows", 2**32, TILES),
        ("hashed_rows", 4_000_000_000, TILES),
        ("low", (0.0,), TILES),
        ("low", (0.7, 0.0), TILES),
        ("high", (0.6, float("inf")), TILES),
        ("algorithm", "sarsa(0.9)", {}),
        ("exploration", "greedy", {}),
        ("on_truncation", "stop", {}),
    ],
)
def test_a_value_out_of_range_is_refused_by_name(name: str, value: Any, settings: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=rf"^{name} .*got "):
        qtab.train("MountainCar-v0", **{"episodes": 10, **settings, name: value})


@pytest.mark.parametrize(
    ("name", "value", "settings"),
    [
        ("trace_decay", "0.9", {"algorithm": "sarsa_lambda"}),
        ("n_steps", 4.0, {"algorithm": "n_step_sarsa"}),
        ("planning_steps", True, {"algorithm": "dyna_q"}),
        ("tilings", 8.0, TILES),
        ("tiles", "88", TILES),
        ("hashed_rows", 1e6, TILES),
        ("low", 0.0, TILES),
        ("ties", 1, {}),
    ],
)
def test_a_value_of_another_type_is_refused_by_name(name: str, value: Any, settings: dict[str, Any]) -> None:
    with pytest.raises(TypeError, match=rf"^{name} must .*got "):
        qtab.train("MountainCar-v0", **{**settings, name: value})


def test_the_config_of_a_run_has_the_values_that_were_used() -> None:
    config = qtab.train("MountainCar-v0", episodes=1, algorithm="sarsa_lambda", **TILES).config
    assert (config.trace_decay, config.traces, config.trace_cutoff) == (0.9, "replacing", 0.0)
    assert (config.epsilon, config.min_epsilon, config.epsilon_schedule, config.ties) == (0.8, 0.0, "linear", "first")
    assert (config.tilings, config.tiles) == (8, (8, 8))
    assert (config.low, config.high) == tuple(
        tuple(np.array(bound, dtype=np.float32).tolist()) for bound in ([-1.2, -0.07], [0.6, 0.07])
    )
    assert (config.n_steps, config.planning_steps, config.temperature, config.epsilon_decay) == (None,) * 4
    assert (config.scale, config.terminal_update) == ((), "target")


def test_a_resolved_config_gives_the_same_run() -> None:
    run = qtab.train("MountainCar-v0", episodes=5, seed=1, algorithm="watkins_q_lambda", exploration="softmax", **TILES)
    again = qtab.train("MountainCar-v0", **{name: value for name, value in vars(run.config).items() if name != "env"})
    assert again.tables.tobytes() == run.tables.tobytes()


def test_given_settings_override_the_preset() -> None:
    run = qtab.train("MountainCar-v0", episodes=1, preset="article", algorithm="n_step_sarsa")
    assert (run.config.terminal_update, run.config.scale) == ("target", (10.0, 100.0))


def test_double_q_learning_has_two_tables_and_acts_on_their_sum() -> None:
    run = qtab.train("MountainCar-v0", episodes=20, seed=0, algorithm="double_q_learning")
    assert run.tables.shape == (2, 285, 3)
    assert run.q_table.tobytes() == (run.tables[0] + run.tables[1]).tobytes()
    observation = np.array([-0.5, 0.0], dtype=np.float32)
    assert run.q_values(observation).tobytes() == run.q_table[7, 7].tobytes()


@pytest.mark.parametrize("algorithm", ["double_q_learning", "sarsa"])
@pytest.mark.parametrize("settings", [{}, TILES])
def test_training_continues_from_the_tables_of_a_run(algorithm: Any, settings: dict[str, Any]) -> None:
    first = qtab.train("MountainCar-v0", episodes=20, seed=0, algorithm=algorithm, **settings)
    more = qtab.train(
        "MountainCar-v0",
        episodes=2,
        seed=1,
        algorithm=algorithm,
        learning_rate=0.0,
        initial_q=first.tables,
        **settings,
    )
    assert more.tables.tobytes() == first.tables.tobytes()
    assert qtab.verify(more).equal


@pytest.mark.slow
def test_treating_truncation_as_termination_hurts_learning() -> None:
    right, wrong = (
        np.mean([qtab.train("MountainCar-v0", seed=seed, on_truncation=way).mean_returns(100)[-1] for seed in range(8)])
        for way in ("bootstrap", "terminate")
    )
    assert wrong < -199
    assert right > -195


DIVERGING: dict[str, Any] = {
    "algorithm": "sarsa_lambda",
    "traces": "accumulating",
    "trace_decay": 1.0,
    "discount": 1.0,
    "learning_rate": 2.0,
    "discretizer": "tiles",
    "epsilon": 0.0,
    "seed": 0,
}


def test_divergence_stops_the_run_with_the_episode_and_the_likely_cause() -> None:
    with pytest.raises(OverflowError, match=r"overflowed in episode \d+ .*learning_rate") as caught:
        qtab.train("MountainCar-v0", **DIVERGING)
    run: qtab.Run = caught.value.run  # type: ignore[attr-defined]
    assert not run.completed
    assert f"episode {len(run.episode_returns) - 1} " in str(caught.value)
    assert len(run.episode_returns) == len(run.episode_lengths) == len(run.terminated)


def test_divergence_is_detected_in_an_endless_episode() -> None:
    with pytest.raises(OverflowError, match="episode 0 "):
        qtab.train("MountainCar-v0", **DIVERGING, max_episode_steps=10**15)


@pytest.mark.parametrize("backend", ["rust", "gymnasium"])
def test_divergence_is_the_same_with_callbacks_and_on_both_backends(backend: Any) -> None:
    episodes = set()
    for every in (1, 7):
        with pytest.raises(OverflowError) as caught:
            qtab.train(
                "MountainCar-v0",
                **DIVERGING,
                backend=backend,
                callback=lambda progress: None,
                callback_every=every,
            )
        episodes.add(len(caught.value.run.episode_returns))  # type: ignore[attr-defined]
    assert len(episodes) == 1


def test_rewards_that_overflow_raise_an_overflow_error() -> None:
    class Huge(gym.Env[Any, Any]):
        observation_space = gym.spaces.Box(0.0, 1.0, (1,), np.float64)
        action_space = gym.spaces.Discrete(2)

        def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
            super().reset(seed=seed)
            return np.array([0.5]), {}

        def step(self, action: int) -> Any:
            reward = 1.7e308 * float(np.sign(self.np_random.uniform(-1, 1)))
            return np.array([0.5]), reward, True, False, {}

    with pytest.raises(OverflowError, match="overflowed") as caught:
        qtab.train(
            Huge(),
            scale=(1,),
            episodes=50,
            seed=0,
            epsilon=1.0,
            epsilon_schedule="constant",
            learning_rate=1.0,
            terminal_update="target",
        )
    assert not np.isfinite(caught.value.run.tables).all()  # type: ignore[attr-defined]


def test_the_command_reports_divergence_in_one_line(capfd: pytest.CaptureFixture[str]) -> None:
    from qtab.cli.command import run

    settings: dict[str, Any] = {**DIVERGING, "env": "MountainCar-v0"}
    flags = [word for name, value in settings.items() for word in (f"--{name.replace('_', '-')}", str(value))]
    code = run(["train", *flags])
    assert code == 1
    assert capfd.readouterr().err.splitlines()[-1].startswith("qtab train: error: the action values overflowed")
