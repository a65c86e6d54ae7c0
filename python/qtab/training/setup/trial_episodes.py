"""The first episodes of a run in a compiled class, compared with Python before the run begins."""

import hashlib
import warnings
from dataclasses import replace
from typing import Any

import gymnasium as gym
from gymnasium.utils import passive_env_checker

from qtab import _core
from qtab.discretizers.time_aware import TimeAware
from qtab.training.setup.environment import PythonEnvironment, observed_masks
from qtab.training.setup.resolved_run import ResolvedRun

STEPS = 500
"""The steps after which the comparison ends."""
EPISODES = 20
LONGEST_EPISODE = 1_000


def differs_from_python(run: ResolvedRun, env: gym.Env) -> str | None:
    """Trains the first episodes of a run in a copy of its environment in Python, too, and compares the bytes.

    What the spaces, the types of observations and rewards, the action masks and the wrappers mean for a run is thereby
    what Python stepping makes of it.

    Args:
        run: A run in compiled code.
        env: Its environment, perhaps in wrappers, which is not changed.

    Returns:
        How the run differs in Python, or the error or the warning there; None without a difference.
    """
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            expected, episodes = _trained(_in_python(run, env), None)
        except Exception as error:  # it is raised again when Python steps the environment
            return f"its first episodes raise {type(error).__name__}: {error}"
    of_checker = [one for one in caught if one.filename == passive_env_checker.__file__]
    if len(caught) > len(of_checker):
        message = next(one.message for one in caught if one not in of_checker)
        return f"it warns in its first episodes, which compiled code does not: {message}"
    try:
        results, _ = _trained(run, episodes)
    except Exception as error:
        return f"its first episodes raise {type(error).__name__} in compiled code only: {error}"
    if results != expected:
        return "its first episodes are different in compiled code"
    for one in of_checker:  # as Gymnasium's checker of first steps would have warned
        warnings.warn_explicit(one.message, one.category, one.filename, one.lineno)
    return None


def _in_python(run: ResolvedRun, env: gym.Env) -> ResolvedRun:
    twin = _copy(env)
    masks = None if run.config.action_mask is False else observed_masks(run.config.action_mask, twin)
    return replace(run, environment=PythonEnvironment(twin, run.actions, False, masks), masks=masks)


def _copy(env: gym.Env) -> gym.Env:
    """Returns a copy of an environment and its wrappers, without a call of their methods."""
    from qtab.compilation.twins.class_twin import twin_of

    if not isinstance(env, gym.Wrapper):
        twin: gym.Env = twin_of(env)
        return twin
    wrapper: Any = object.__new__(type(env))
    vars(wrapper).update({**vars(env), "env": _copy(env.env)})
    return wrapper  # type: ignore[no-any-return]


def _trained(run: ResolvedRun, episodes: int | None) -> tuple[list[bytes], int]:
    """Trains so many episodes, or as many as take ``STEPS``; returns digests of the results, and their number."""
    spec = run.spec()
    if not isinstance(run.discretizer, TimeAware):
        spec["max_episode_steps"] = min(run.max_episode_steps, LONGEST_EPISODE)
    trainer = _core.Trainer(spec, run.seed)
    done = 0
    while episodes is None and done < min(EPISODES, run.config.episodes):
        done += 1
        trainer.advance(done)
        if trainer.episodes()[1].sum() >= STEPS:
            break
    if episodes is not None:
        trainer.advance(episodes)
    masks = trainer.action_masks()
    columns = [trainer.tables(), *trainer.episodes(), *([] if masks is None else [masks])]
    return [hashlib.sha256(column.tobytes()).digest() for column in columns], done
