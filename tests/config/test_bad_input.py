"""Bad input is refused before training starts: the error names the argument and shows the value."""

import re
import subprocess
import sys
from decimal import Decimal
from fractions import Fraction
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from support.environments import ScriptedEnv, Walk
from support.processes.posix import posix_only

NO_NUMBERS: list[Any] = ["0.5", b"0.5", None, True, np.True_, 0.5j, [0.5], (0.5,), np.array([0.5]), {}]
NO_INTEGERS = [1.0, 2.5, float("nan"), "5", True, np.True_, [5], np.array([5]), Fraction(5)]
NO_RANGES = [0.5, "zeros", None, (0.0,), (0.0, "1"), (0, 1, 2), {"low": 0}, [["a"]], (True, False)]
NAN, INFINITY = float("nan"), float("inf")
HUGE = 10**400
RATES = "learning_rate", "discount", "epsilon", "min_epsilon"


def refused(error, name, value, **settings):
    """Training refuses the value before anything runs; the error names the argument and shows the value."""
    with pytest.raises(error) as caught:
        qtab.train("MountainCar-v0", **{name: value} | settings)
    message = str(caught.value)
    assert message.startswith(f"{name} must "), message
    assert repr(value) in message
    assert not hasattr(caught.value, "run")
    with pytest.raises(error, match=f"^{name} must "):
        qtab.Config(**{name: value} | settings)


@pytest.mark.parametrize("name", RATES)
@pytest.mark.parametrize(
    "value",
    [NAN, INFINITY, -INFINITY, -0.1, 1.1, 1.0000000000000002, -5e-324, 2, -1, HUGE, np.float32("nan"), Decimal("NaN")],
    ids=lambda value: str(value)[:20],
)
def test_a_rate_outside_0_to_1_is_refused(name, value):
    refused(ValueError, name, value)


@pytest.mark.parametrize("name", RATES)
@pytest.mark.parametrize("value", [value for value in NO_NUMBERS if value is not None], ids=repr)
def test_a_rate_of_another_type_is_refused(name, value):
    refused(TypeError, name, value)


@pytest.mark.parametrize("name", RATES)
@pytest.mark.parametrize("value", [0, 1, 0.5, np.float32(0.5), Fraction(1, 2), Decimal("0.5"), np.array(0.5)], ids=repr)
def test_every_real_number_in_range_is_a_rate(name, value):
    others = {"epsilon": 1.0} if name == "min_epsilon" else {"min_epsilon": 0.0}
    run = qtab.train("MountainCar-v0", seed=0, episodes=1, max_episode_steps=5, **{name: value} | others)
    assert getattr(run.config, name) == float(value)
    assert type(getattr(run.config, name)) is float


@pytest.mark.parametrize(("epsilon", "min_epsilon"), [(0.1, 0.2), (0.0, 1.0), (0.5, 0.5000000000000001)])
def test_a_minimum_above_epsilon_is_refused(epsilon, min_epsilon):
    refused(ValueError, "min_epsilon", min_epsilon, epsilon=epsilon)


COUNTS = "episodes", "max_episode_steps"


@pytest.mark.parametrize("name", COUNTS)
@pytest.mark.parametrize("value", [0, -1, -(10**30), 2**63, 10**30, np.int64(0)])
def test_a_count_out_of_range_is_refused(name, value):
    refused(ValueError, name, value)


@pytest.mark.parametrize("name", COUNTS)
@pytest.mark.parametrize("value", NO_INTEGERS, ids=repr)
def test_a_count_of_another_type_is_refused(name, value):
    refused(TypeError, name, value)


def test_no_episodes_at_all_is_refused():
    refused(TypeError, "episodes", None)


@pytest.mark.parametrize("bit_generator", ["PCG64", "MT19937"])
@pytest.mark.parametrize("value", [-1, -(2**70), np.int64(-5)])
def test_a_negative_seed_is_refused(bit_generator, value):
    refused(ValueError, "seed", value, bit_generator=bit_generator)


@pytest.mark.parametrize("bit_generator", ["PCG64", "MT19937"])
@pytest.mark.parametrize("value", NO_INTEGERS, ids=repr)
def test_a_seed_that_is_no_integer_is_refused(bit_generator, value):
    refused(TypeError, "seed", value, bit_generator=bit_generator)


@pytest.mark.parametrize("value", [2**32, 2**64, np.uint64(2**63)])
def test_mt19937_accepts_only_seeds_of_32_bits(value):
    refused(ValueError, "seed", value, bit_generator="MT19937")


@pytest.mark.parametrize("seed", [0, 2**32 - 1, np.uint8(7), np.int64(2**40), 2**64, 2**300, np.array(3)])
@pytest.mark.parametrize("backend", ["rust", "gymnasium"])
def test_pcg64_takes_any_non_negative_integer(seed, backend):
    run = qtab.train("MountainCar-v0", seed=seed, episodes=1, max_episode_steps=5, backend=backend)
    assert run.config.seed == int(seed)
    assert type(run.config.seed) is int


CHOICES = {
    "bit_generator": ["pcg64", "PCG64DXSM", "", "Philox"],
    "backend": ["Rust", "Python", "cuda", ""],
    "terminal_update": ["Assign", "book", ""],
}


@pytest.mark.parametrize(("name", "value"), [(name, value) for name, values in CHOICES.items() for value in values])
def test_an_unknown_choice_is_refused(name, value):
    refused(ValueError, name, value)


@pytest.mark.parametrize("name", CHOICES)
@pytest.mark.parametrize("value", [None, 1, b"PCG64", np.random.PCG64, ["rust"]], ids=str)
def test_a_choice_of_another_type_is_refused(name, value):
    refused(TypeError, name, value)


@pytest.mark.parametrize("value", ["articel", "", "ARTICLE"])
def test_an_unknown_preset_is_refused_with_the_known_ones(value):
    with pytest.raises(
        ValueError, match=f"preset must be one of 'article', 'solved' for MountainCar-v0, got {value!r}"
    ):
        qtab.train("MountainCar-v0", preset=value)
    with pytest.raises(TypeError, match="preset must be a name, got 5"):
        qtab.train("MountainCar-v0", preset=5)  # type: ignore[arg-type]


@pytest.mark.parametrize("value", [(0.0, -1.0), (NAN, 1.0), (0.0, INFINITY), (-1.7e308, 1.7e308), (0, HUGE)])
def test_an_invalid_range_of_initial_values_is_refused(value):
    with pytest.raises(ValueError, match=r"^initial_q must be"):
        qtab.train("MountainCar-v0", initial_q=value)


_TABLES = [np.ones((19, 15, 3), dtype) for dtype in (complex, str, bytes, bool, "M8[s]")]


@pytest.mark.parametrize(
    "value", [*_TABLES, "zeros", None, (0.0,), (0.0, "1"), (0, 1, 2), {"low": 0}, [["a"]], (True, False)]
)
def test_initial_values_of_another_type_are_refused(value):
    with pytest.raises(TypeError, match=r"^initial_q must be"):
        qtab.train("MountainCar-v0", initial_q=value)


@pytest.mark.parametrize("shape", [(19, 15), (285, 3), (15, 19, 3), (19, 15, 4), (0,), (1, 19, 15, 3)])
def test_an_initial_table_of_another_shape_is_refused_with_both_shapes(shape):
    with pytest.raises(ValueError, match=re.escape(f"initial_q must have the table's shape (19, 15, 3), got {shape}")):
        qtab.train("MountainCar-v0", initial_q=np.zeros(shape))


@pytest.mark.parametrize("value", [NAN, INFINITY])
def test_an_initial_table_that_is_not_finite_is_refused(value):
    with pytest.raises(ValueError, match="initial_q must hold finite numbers"):
        qtab.train("MountainCar-v0", initial_q=np.full((19, 15, 3), value))


@pytest.mark.parametrize("value", [(0, 100), (-10, 100), (NAN, 100), (INFINITY, 1), (10, HUGE)])
def test_a_scale_that_is_not_positive_and_finite_is_refused(value):
    with pytest.raises(ValueError, match=r"^scale must "):
        qtab.train("MountainCar-v0", scale=value)


@pytest.mark.parametrize("value", [10, "10,100", None, ("10", "100"), (True, 100), 10.0])
def test_a_scale_of_another_type_is_refused(value):
    with pytest.raises(TypeError, match=r"^scale must "):
        qtab.train("MountainCar-v0", scale=value)


@pytest.mark.parametrize("value", [(10,), (10, 100, 1)])
def test_a_scale_of_another_length_is_refused_with_its_length(value):
    with pytest.raises(ValueError, match=r"scale must hold 2 numbers .* got \("):
        qtab.train("MountainCar-v0", scale=value)


def test_a_scale_that_is_not_given_is_not_quoted():
    with pytest.raises(ValueError, match=r"^scale must be given and hold 2 numbers [^\[(]*, or discretizer='bins' or"):
        qtab.train("MountainCar-v0", scale=())


@pytest.mark.parametrize("value", [(1e9, 1e9), (1e300, 1e300)])
def test_a_table_too_large_is_refused_with_the_scale(value):
    with pytest.raises(ValueError, match=r"^scale must give a table "):
        qtab.train("MountainCar-v0", scale=value)


@posix_only
def test_a_table_that_does_not_fit_into_memory_is_refused_and_the_process_continues():
    code = """
import resource, qtab
resource.setrlimit(resource.RLIMIT_AS, (3 * 2**30, 3 * 2**30))
try:
    qtab.train("MountainCar-v0", scale=(30_000, 25_000), episodes=1)
except ValueError as error:
    print(error)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=600)
    assert done.stdout.startswith("scale must give a table that fits into memory, got (30000.0, 25000.0)")


@pytest.mark.parametrize("value", [[("goal_velocity", 0.1)], "goal_velocity=0.1", 5, {1: 2}, None], ids=repr)
def test_invalid_env_kwargs_are_refused(value):
    refused(TypeError, "env_kwargs", value)


@pytest.mark.parametrize("name", ["callback_every", "record"])
@pytest.mark.parametrize(("value", "error"), [(-1, ValueError), (1.5, TypeError), (True, TypeError), ("9", TypeError)])
def test_callback_every_and_record_are_checked(name, value, error):
    with pytest.raises(error, match=f"^{name} must be an integer .* got {value!r}"):
        qtab.train("MountainCar-v0", **{name: value})


def test_an_unknown_setting_is_named_with_the_one_that_was_probably_meant():
    with pytest.raises(TypeError, match=r"^unknown setting 'learning' \(did you mean 'learning_rate'\?\)$"):
        qtab.train("MountainCar-v0", learning=0.2)  # type: ignore[call-arg]


@pytest.mark.parametrize("env", [None, 3, b"MountainCar-v0", ["MountainCar-v0"], gym.Env], ids=repr)
def test_an_invalid_environment_is_refused(env):
    with pytest.raises(
        TypeError, match=re.escape(f"env must be an environment id, an EnvSpec or an environment, got {env!r}")
    ):
        qtab.train(env)


UNKNOWN = {
    "MountainCr-v0": (gym.error.NameNotFound, "Did you mean: `MountainCar`"),
    "MountainCar-v9": (gym.error.VersionNotFound, "v0"),
    "qtabb/MountainCar-v0": (gym.error.NamespaceNotFound, "Did you mean: `qtab`"),
    "": (gym.error.Error, "Malformed environment ID"),
    "no such thing": (gym.error.Error, "Malformed environment ID"),
}


@pytest.mark.parametrize(("env", "answer"), UNKNOWN.items(), ids=UNKNOWN)
def test_an_unknown_environment_raises_gymnasiums_error_with_its_suggestion(env, answer):
    error, suggestion = answer
    with pytest.raises(error, match=re.escape(suggestion)):
        qtab.train(env)


def test_an_unknown_keyword_argument_raises_gymnasiums_error():
    with pytest.raises(TypeError, match="unexpected keyword argument 'wheels'"):
        qtab.train("MountainCar-v0", env_kwargs={"wheels": 4})


def mixed():
    env = ScriptedEnv([])
    env.observation_space = gym.spaces.Tuple((gym.spaces.Discrete(3), env.observation_space))
    return env


SPACES = {
    "continuous actions": (
        ScriptedEnv([], actions=gym.spaces.Box(-1, 1, (2,))),
        "^actions must be given for the action space Box",
    ),
    "observations of two kinds": (
        mixed(),
        "scale must hold 1 number for",
    ),
    "unbounded observations": (
        "CartPole-v1",
        "observation space must have finite bounds for discretizer 'round', got Box.*take low= and high=, such as ",
    ),
    "an image": (
        ScriptedEnv([], dtype=np.uint8, high=255, dimensions=100),
        "scale must hold 100 numbers",
    ),
    "texts": (ScriptedEnv([], actions=gym.spaces.Text(3)), "action space must be Discrete, MultiDiscrete"),
    "too many actions": (ScriptedEnv([], actions=gym.spaces.MultiBinary(17)), "at most 65536 actions, got .* 131,072"),
}


@pytest.mark.parametrize(("env", "message"), SPACES.values(), ids=SPACES)
def test_unsupported_spaces_are_refused_with_what_is_supported(env, message):
    with pytest.raises(ValueError, match=message):
        qtab.train(env, discretizer="round", scale=(1.0, 1.0))


def test_a_box_of_two_axes_has_a_number_for_each_component():
    env = Walk()
    env.observation_space = gym.spaces.Box(0.0, 4.0, (2, 2), np.float32)
    with pytest.raises(ValueError, match=r"scale must hold 4 numbers .* got \(1.0, 1.0\)"):
        qtab.train(env, scale=(1.0, 1.0))
