"""The environments of a sweep: their descriptions in its store, checks that they are unchanged, and thresholds."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any

import gymnasium as gym

from qtab.config import Config
from qtab.envs.metadata.goals import reward_threshold
from qtab.envs.origin.class_code import LIBRARY
from qtab.envs.origin.description import EnvironmentDescription, differences, from_json
from qtab.envs.origin.values import with_types
from qtab.envs.registry import entry_for_id, make_env, spec_of
from qtab.sweeps.connection import StoreError, damaged, name_of
from qtab.training.repetition import encoded
from qtab.training.setup.resolved_run import ResolvedRun
from qtab.training.setup.run_env import environment_of

if TYPE_CHECKING:
    from qtab.sweeps.results import Sweep

FINGERPRINT_STEPS = 100

Environment = tuple[str, Mapping[str, Any], int, EnvironmentDescription | None]
"""The id, the keyword arguments and the time limit of settings, and the details of their environment, if known."""


def describe_environments(env: Any, resolved: Sequence[ResolvedRun]) -> str:
    """Returns JSON text: each different environment of a study, with a fingerprint of its dynamics and its settings.

    Args:
        env: The environment of the study: an id, an EnvSpec, or a function that makes one.
        resolved: A run of each setting.
    """
    found: dict[str, dict[str, Any]] = {}
    for setting, run in enumerate(resolved):
        content = environment_of(run).as_json()
        text = json.dumps(content, sort_keys=True)
        if text not in found:
            found[text] = {"environment": content, "fingerprint": _fingerprint(env, run), "settings": []}
        found[text]["settings"].append(setting)
    return json.dumps(list(found.values()))


def stored_environments(meta: Mapping[str, str], settings: int, path: Path | None) -> dict[int, EnvironmentDescription]:
    """Returns the environments of a store by the indices of their settings, as far as the store describes them.

    Raises:
        StoreError: if the descriptions are damaged.
    """
    found: dict[int, EnvironmentDescription] = {}
    try:
        content = json.loads(meta.get("environments", "[]"))
        for one in content:
            environment = from_json(one["environment"])
            for setting in one.get("settings", range(settings if len(content) == 1 else 0)):
                if type(setting) is not int or not 0 <= setting < settings:
                    raise ValueError(f"its environment has a setting {setting!r:.40}")
                found[setting] = environment
    except (AttributeError, KeyError, RecursionError, TypeError, ValueError) as error:
        raise damaged(path, error) from error
    return found


def check_environments(stored: str | None, ours: str, path: Path | None) -> None:
    """Checks that the environments of a study are those of its store; stores of earlier versions hold none.

    Raises:
        StoreError: if an environment differs, or now behaves differently.
    """
    if stored is None or stored == ours:
        return
    try:
        before = [(from_json(one["environment"]), one["fingerprint"]) for one in json.loads(stored)]
    except (KeyError, TypeError, ValueError) as error:
        raise damaged(path, error) from error
    now = [(from_json(one["environment"]), one["fingerprint"]) for one in json.loads(ours)]
    if len(before) != len(now):
        raise StoreError(f"{name_of(path)} belongs to a sweep of {len(before)} environments, not of {len(now)}")
    for (then, fingerprint), (here, another) in zip(before, now, strict=True):
        if found := differences(then, here):
            raise StoreError(
                f"{name_of(path)} belongs to a sweep of another environment: {'; '.join(found)}; choose another file"
            )
        if None not in (fingerprint, another) and fingerprint != another:
            raise StoreError(
                f"{name_of(path)} has results of an earlier {then.name}: with the same seed and actions it now gives "
                "other observations or rewards; choose another file"
            )


def _fingerprint(env: Any, run: ResolvedRun) -> str | None:
    """Returns a digest of some steps of a random policy; None if they do not repeat, fail, or run in Rust."""
    description = environment_of(run)
    if description.code == LIBRARY and description.id is not None and entry_for_id(description.id) is not None:
        return None  # for Rust, the stored versions identify the code
    try:
        first, second = (_played(env, run.config) for _ in range(2))
    except Exception:  # an environment may raise anything
        return None
    return first if first == second else None


def _played(env: Any, config: Config) -> str:
    with closing(_made(env, config)) as playing:
        digest = hashlib.sha256(encoded(playing.reset(seed=0)[0]))
        playing.action_space.seed(0)
        for _ in range(FINGERPRINT_STEPS):
            observation, reward, terminated, truncated, _ = playing.step(playing.action_space.sample())
            digest.update(encoded((observation, reward, terminated, truncated)))
            if terminated or truncated:
                digest.update(encoded(playing.reset()[0]))
        return digest.hexdigest()[:32]


def _made(env: Any, config: Config) -> gym.Env:
    if callable(env):
        made: gym.Env = env()
        return made
    return make_env(spec_of(env) if isinstance(env, str) else env, config.env_kwargs)


def sweep_threshold(sweep: "Sweep", setting: int | None = None) -> float | None:
    """Returns the threshold of a setting, or None; see :func:`qtab.envs.metadata.goals.reward_threshold`.

    Args:
        sweep: The sweep.
        setting: The index of the setting; None means all settings, which must then have the same threshold.
    """
    found = {reward_threshold(*environment) for environment in environments_of(sweep, setting)}
    return found.pop() if len(found) == 1 else None


def environments_of(sweep: "Sweep", setting: int | None = None) -> list[Environment]:
    """Returns the different environments of one or all settings; an empty list for a sweep without configs."""
    found: dict[str, Environment] = {}
    for index, config in enumerate(sweep.configs):
        if setting is None or index == setting:
            description = sweep._environments.get(index)
            given = config["env_kwargs"]
            kwargs = given if description is None else with_types(given, description.kwargs)
            environment = (config["env"], kwargs, config["max_episode_steps"], description)
            found.setdefault(repr(environment), environment)
    return list(found.values())
