"""Errors suggest what was probably meant: misspelled settings, other libraries' names for them, wrong choices."""

import re
from typing import Any

import numpy as np
import pytest

import qtab

CAR = "MountainCar-v0"
OTHER_NAMES = {
    "learnig_rate": "learning_rate",
    "Learning_Rate": "learning_rate",
    "alpha": "learning_rate",
    "lr": "learning_rate",
    "step_size": "learning_rate",
    "gamma": "discount",
    "gama": "discount",
    "discount_factor": "discount",
    "n_episodes": "episodes",
    "num_episodes": "episodes",
    "eps": "epsilon",
    "epsilon_min": "min_epsilon",
    "exploration_final_eps": "min_epsilon",
    "lambda_": "trace_decay",
    "lam": "trace_decay",
    "n": "n_steps",
    "tau": "temperature",
    "kappa": "time_weight",
    "num_tilings": "tilings",
    "tile": "tiles",
    "random_state": "seed",
    "max_steps": "max_episode_steps",
    "algo": "algorithm",
    "policy": "exploration",
    "q_init": "initial_q",
    "callbak": "callback",
    "verbose": "progress",
}


@pytest.mark.parametrize(("name", "ours"), OTHER_NAMES.items())
def test_an_unknown_setting_names_the_one_that_was_meant(name: str, ours: str) -> None:
    with pytest.raises(TypeError) as caught:
        qtab.train(CAR, **{name: 1})  # type: ignore[arg-type]
    assert str(caught.value) == f"unknown setting {name!r} (did you mean {ours!r}?)"


@pytest.mark.parametrize(
    ("sigma", "message"),
    [
        (1.0, "sigma applies to algorithm 'n_step_q_sigma', not to 'q_learning', got 1.0"),
        (2.0, "sigma must lie in [0, 1], got 2.0"),
        ((1.0, 2.0), "sigma must be a number in [0, 1], got (1.0, 2.0)"),
    ],
)
def test_the_sigma_of_radial_basis_functions_is_their_width(sigma: Any, message: str) -> None:
    with pytest.raises((TypeError, ValueError), match=f"^{re.escape(message)} \\(did you mean 'width'\\?\\)$"):
        qtab.train(CAR, discretizer="radial", sigma=sigma)
    with pytest.raises((TypeError, ValueError), match=f"^{re.escape(message)}$"):
        qtab.train(CAR, discretizer="tiles", sigma=sigma)
    with pytest.raises(TypeError, match=r"^unknown argument 'sigma' \(did you mean 'width'\?\)$"):
        qtab.estimate_values(CAR, "random", discretizer="radial", sigma=sigma)  # type: ignore[call-arg]


def test_steps_are_not_episodes() -> None:
    message = "unknown setting 'total_timesteps' (did you mean 'episodes'? qtab counts episodes, not steps)"
    with pytest.raises(TypeError, match=f"^{re.escape(message)}$"):
        qtab.train(CAR, total_timesteps=10_000)  # type: ignore[call-arg]


def test_nothing_is_suggested_where_nothing_is_similar() -> None:
    message = "unknown setting 'colour'; help(qtab.train) and qtab train --help list the settings"
    message += "; arguments of an environment are given as env_kwargs={'colour': ...}"
    with pytest.raises(TypeError, match=f"^{re.escape(message)}$"):
        qtab.Config().replace(colour="red")  # type: ignore[call-arg]


def test_arguments_of_environments_are_env_kwargs() -> None:
    message = "unknown setting 'is_slippery' (did you mean env_kwargs={'is_slippery': ...}?)"
    with pytest.raises(TypeError, match=f"^{re.escape(message)}$"):
        qtab.train("FrozenLake-v1", is_slippery=False)  # type: ignore[call-arg]
    run = qtab.train("FrozenLake-v1", episodes=1, seed=0)
    with pytest.raises(TypeError, match=r"^unknown argument 'epsilon'; help\(qtab.evaluate\) lists the arguments$"):
        qtab.evaluate(run, epsilon=0.1)  # type: ignore[call-arg]


@pytest.mark.parametrize("name", ["seed", "n_seeds", "num_runs"])
def test_many_runs_take_seeds(name: str) -> None:
    with pytest.raises(TypeError, match=rf"^unknown setting '{name}' \(did you mean 'seeds'\?\)$"):
        qtab.train_many(CAR, **{name: 3})  # type: ignore[arg-type]


def test_other_workers_are_threads() -> None:
    with pytest.raises(TypeError, match=r"'n_jobs' \(did you mean 'threads'\?\)$"):
        qtab.sweep(CAR, {"epsilon": [0.1]}, 2, n_jobs=2)  # type: ignore[call-arg]


@pytest.mark.parametrize(
    ("name", "value", "meant"),
    [
        ("algorithm", "qlearning", "q_learning"),
        ("algorithm", "Q-learning", "q_learning"),
        ("algorithm", "SARSA", "sarsa"),
        ("algorithm", "sarsa(lambda)", "sarsa_lambda"),
        ("algorithm", "dyna_q+", "dyna_q"),
        ("exploration", "eps_greedy", "epsilon_greedy"),
        ("discretizer", "tile", "tiles"),
        ("bit_generator", "pcg64", "PCG64"),
        ("backend", "Rust", "rust"),
        ("learning_rate_schedule", "exponential_decay", "exponential"),
    ],
)
def test_a_wrong_choice_names_the_nearest_one(name: str, value: str, meant: str) -> None:
    with pytest.raises(ValueError, match=rf"^{name} must be one of '.*', got {re.escape(repr(value))}") as caught:
        qtab.train(CAR, **{name: value})  # type: ignore[arg-type]
    assert str(caught.value).endswith(f" (did you mean {meant!r}?)")


@pytest.mark.parametrize("value", ["", "cuda", "Philox"])
def test_a_choice_that_is_far_from_all_suggests_none(value: str) -> None:
    with pytest.raises(ValueError, match=f"^backend must be one of 'auto', 'rust', .*'python', got '{value}'$"):
        qtab.train(CAR, backend=value)  # type: ignore[arg-type]


def test_a_wrong_preset_names_the_nearest_one() -> None:
    with pytest.raises(ValueError, match=r"^preset must be one of .*, got 'articel' \(did you mean 'article'\?\)$"):
        qtab.train(CAR, preset="articel")
    with pytest.raises(ValueError, match=r"^preset must be left out for BipedalWalker-v3, .* none, got 'solved'$"):
        qtab.train("BipedalWalker-v3", preset="solved")


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (
            {"trace_decay": 0.9},
            "trace_decay applies to algorithm 'sarsa_lambda', 'watkins_q_lambda', 'true_online_sarsa_lambda' "
            "or 'actor_critic_lambda', not to 'q_learning', got 0.9",
        ),
        (
            {"n_steps": np.int64(2)},
            "n_steps applies to algorithm 'n_step_sarsa', 'n_step_tree_backup' or 'n_step_q_sigma', not to "
            "'q_learning', got 2",
        ),
        (
            {"epsilon_decay": 0.9, "exploration": "softmax"},
            "epsilon_decay applies to exploration 'epsilon_greedy', not to 'softmax', got 0.9",
        ),
        (
            {"algorithm": "true_online_sarsa_lambda", "learning_rate_schedule": "visits"},
            "learning_rate_schedule must be 'constant', 'linear' or 'exponential' "
            "for algorithm 'true_online_sarsa_lambda', got 'visits'",
        ),
    ],
)
def test_settings_that_do_not_apply_say_what_they_apply_to(settings: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        qtab.Config(**settings)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", ["algorithm", "exploration", "discretizer"])
def test_a_choice_cannot_be_none(name: str) -> None:
    with pytest.raises(TypeError, match=f"^{name} must be one of .*, got None$"):
        qtab.train(CAR, **{name: None})  # type: ignore[arg-type]
