"""The classes of classic control: registration, rendering, copies, and machines with another sine."""

import copy
import os
import pickle
import subprocess
import sys
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

from support.exact import bitwise
from support.lockstep.classic_control import EDITS, IDS, LockstepClassicControl, heuristic_policy

os.environ.setdefault("SDL_VIDEODRIVER", "dummy")


@pytest.mark.parametrize("name", IDS)
def test_pixels_equal_gymnasiums(name):
    pair = LockstepClassicControl(name, render_mode="rgb_array")
    pair.reset(seed=8)
    for _ in range(3):
        pair.both(lambda env: env.render())
        pair.run(5, heuristic_policy)
    pair.both(lambda env: env.close())


@pytest.mark.parametrize("name", IDS)
def test_every_step_is_rendered_in_human_mode(name):
    shown = []
    env: Any = gym.make(f"qtab/{name}").unwrapped
    env.reset(seed=0)
    env.render_mode = "human"
    object.__getattribute__(env, "__dict__")["render"] = lambda: shown.append(bitwise(np.array(env.state)))
    for _ in range(3):
        env.step(env.action_space.sample())
    assert len(set(shown)) == 3


@pytest.mark.parametrize("name", IDS)
@pytest.mark.parametrize("copied", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))])  # noqa: S301
def test_a_copy_continues_like_its_original(name, copied):
    pair = LockstepClassicControl(name)
    copied(pair.ours)
    pair.reset(seed=9)
    pair.run(30)
    attribute, value = next(iter(EDITS[name].items()))
    pair.set(**{attribute: value})
    original, pair.ours = pair.ours, copied(pair.ours)
    original.step(original.action_space.sample())
    pair.run(300)


@pytest.mark.filterwarnings("ignore:.*out of date")
@pytest.mark.parametrize("name", [*IDS, "CartPole-v0"])
def test_limits_thresholds_and_spaces_equal_gymnasiums(name):
    ours, theirs = gym.spec(f"qtab/{name}"), gym.spec(name)
    for field in ("max_episode_steps", "reward_threshold", "nondeterministic", "order_enforce", "disable_env_checker"):
        assert getattr(ours, field) == getattr(theirs, field), field
    pair = LockstepClassicControl(name)
    pair.both(lambda env: (env.observation_space == pair.theirs.observation_space, env.metadata))
    pair.both(lambda env: env.action_space == pair.theirs.action_space)


def fresh(code: str) -> str:
    return subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True).stdout


def test_an_id_with_a_module_imports_it():
    code = "import gymnasium as g; e = g.make('qtab:qtab/CartPole-v1'); e.reset(); print(type(e.unwrapped).__module__)"
    assert fresh(code).strip() == "qtab.envs.classic_control"


def test_steps_equal_gymnasiums_where_numpy_does_not_use_libm():
    """Runs as on a CPU for which NumPy has its own vector code, in a fresh process."""
    assert fresh(PATCHED).split() == ["False", "1", "equal"]


PATCHED = """
import warnings, numpy as np
true = np.sin
np.sin = lambda x, *rest: np.nextafter(true(x, *rest), 2.0) if np.ndim(x) else np.nextafter(true(x), x.dtype.type(2.0))
import gymnasium as gym, qtab
from qtab import _core
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    ours, theirs = gym.make("qtab/CartPole-v1").unwrapped, gym.make("CartPole-v1").unwrapped
    ours.reset(seed=0), theirs.reset(seed=0)
    for _ in range(9):
        one, other = ours.step(1), theirs.step(1)
        assert one[0].tobytes() == other[0].tobytes() and ours.state.tobytes() == theirs.state.tobytes()
print(_core.numpy_uses_libm(), sum("sin and cos" in str(w.message) for w in caught), "equal")
"""
