"""From what a user asked for to what will be run: the environment found, every default filled in."""

import logging
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.envs.registration import EnvSpec

from qtab import _core, _spec
from qtab.config import DEFAULTS, Config
from qtab.config.options import defaults, mismatch, n_tables
from qtab.config.presets import preset
from qtab.config.unknown import check_names
from qtab.discretizers.actions import Actions, actions
from qtab.discretizers.base import Features
from qtab.discretizers.bins import Bins, bins
from qtab.discretizers.identity import cells, components
from qtab.discretizers.rounding import grid
from qtab.discretizers.tile_coding import Tiling, tiling
from qtab.envs.matching import entry_for_env, is_tabular_env, rust_unavailable, time_limit
from qtab.envs.native import native_env
from qtab.envs.registry import EnvEntry, entry_for_spec, spec_of, versioned
from qtab.training import agent_spec

_LOGGER = logging.getLogger("qtab")
_limited: set[str] = set()
"""The environments whose want of a time limit was said in this process."""
UNLIMITED_MAX_EPISODE_STEPS = 10_000
"""The time limit in training of an environment that has none of its own."""


@dataclass(frozen=True)
class Resolved:
    """A config without gaps, and what it is run on."""

    config: Config
    grid: Features
    model: EnvEntry | None
    """The model in Rust; None steps ``env`` in Python."""
    env: gym.Env | None
    """The environment stepped in Python."""
    made: bool
    """Whether the environment was made here, and so is closed here."""
    native: _core.NativeEnv | None = None
    """The environment that Rust steps."""
    limited: bool = False
    """Whether the time limit is ours, the environment having none."""

    def close(self) -> None:
        """Closes the environment if it was made here."""
        if self.made and self.env is not None:
            self.env.close()

    def spec(self) -> _spec.RunSpec:
        """Returns the run's description as the extension module takes it."""
        config = self.config
        assert config.max_episode_steps is not None  # noqa: S101 - resolved
        return {
            "env": self._environment(),
            "discretizer": self.grid.spec(),
            "num_actions": self.grid.actions,
            "max_episode_steps": config.max_episode_steps,
            "algorithm": agent_spec.algorithm(config),
            "policy": agent_spec.policy(config),
            "learning_rate": agent_spec.learning_rate(config),
            "discount": config.discount,
            "initial_q": agent_spec.initial_q(config),
            "terminal_update": config.terminal_update,
            "on_truncation": config.on_truncation,
            "episodes": config.episodes,
            "bit_generator": config.bit_generator,
        }

    def _environment(self) -> _spec.EnvironmentSpec:
        if self.native is not None:
            return {"type": "native", "env": self.native}
        choices = self.grid.choices
        return {
            "type": "python",
            "env": self.env,
            "first_action": self.grid.first_action,
            "actions": choices.arrays(),
        }

    @property
    def seed(self) -> int:
        """The seed, which is always set."""
        assert self.config.seed is not None  # noqa: S101 - resolved
        return self.config.seed


def merge(env: str, *layers: Mapping[str, Any]) -> Config:
    """Returns the config of an environment: its preset, then each layer over the one before.

    Raises:
        TypeError: for an unknown or mistyped setting.
        ValueError: for a setting out of range, or an unknown preset.
    """
    explicit: dict[str, Any] = {}
    for layer in layers:
        check_names(layer, DEFAULTS)
        explicit.update(layer)
    name = explicit.pop("preset", None)
    if name is not None and not isinstance(name, str):
        raise TypeError(f"preset must be a name, got {name!r}")
    name, values = preset(env, name)
    # A preset is a start: of what it says, that falls away which has no meaning beside what was asked for.
    wanted = {**DEFAULTS, **values, **explicit}
    values = {field: value for field, value in values.items() if not mismatch(field, value, wanted)}
    return Config(**{**values, **explicit, "env": env, "preset": name})


def resolve(env: str | EnvSpec | gym.Env, *layers: Mapping[str, Any]) -> Resolved:
    """Finds the environment and fills in what is left open.

    Raises:
        gymnasium.error.Error: Gymnasium's own, for an id that it does not know.
        TypeError: for what is no environment.
        ValueError: if the backend or the spaces do not fit the environment.
    """
    if isinstance(env, str | EnvSpec):
        return _from_spec(env, *layers)
    if isinstance(env, gym.Env):
        return _from_object(env, *layers)
    raise TypeError(f"env must be an environment id, an EnvSpec or an environment, got {env!r}")


def _from_spec(env: str | EnvSpec, *layers: Mapping[str, Any]) -> Resolved:
    # An id keeps the package that it names, so that the config makes the environment anywhere.
    if isinstance(env, str):
        env = versioned(env)
    name, spec = (env.id, env) if isinstance(env, EnvSpec) else (env, spec_of(env))
    config = merge(name, {"env_kwargs": dict(spec.kwargs)}, *layers)
    model = entry_for_spec(spec, config.env_kwargs)
    if model is None and config.backend == "rust":
        raise rust_unavailable(f"Rust does not implement {spec.id} with these keyword arguments and wrappers")
    limit: dict[str, Any] = {}
    if config.max_episode_steps is not None:
        limit["max_episode_steps"] = config.max_episode_steps
    made = gym.make(spec, **config.env_kwargs, **limit)
    try:
        resolved = _resolved(made, model, config, spec.max_episode_steps, layers, made=True)
    except BaseException:
        made.close()
        raise
    if resolved.model is not None:
        made.close()
    return resolved


def _from_object(env: gym.Env, *layers: Mapping[str, Any]) -> Resolved:
    name = env.spec.id if env.spec is not None else type(env.unwrapped).__name__
    kwargs = dict(env.spec.kwargs) if env.spec is not None else {}
    config = merge(name, {"env_kwargs": kwargs}, *layers)
    if config.backend == "auto":
        config = config.replace(backend="rust" if is_tabular_env(env) else "gymnasium")
    model = entry_for_env(env) if config.backend == "rust" else None
    return _resolved(env, model, config, time_limit(env), layers, made=False)


def _resolved(
    env: gym.Env,
    model: EnvEntry | None,
    config: Config,
    own_limit: int | None,
    layers: tuple[Mapping[str, Any], ...],
    *,
    made: bool,
) -> Resolved:
    """What is run, on the model where Rust can step by what the environment holds and is not kept from it."""
    config = _fitting(env, config, *layers)
    choices = actions(env.action_space, config.actions)
    native = None
    if model is not None and config.backend != "gymnasium":
        try:
            native = native_env(model.name, env.unwrapped, choices)
        except (TypeError, ValueError) as error:
            if config.backend == "rust":
                raise rust_unavailable(str(error)) from None
    table = _features(env, config, choices)
    steps = config.max_episode_steps or own_limit
    config = _complete(config, table, "gymnasium" if native is None else "rust", steps)
    model, stepped = (None, env) if native is None else (model, None)
    return Resolved(config, table, model, stepped, made, native, limited=steps is None)


def _fitting(env: gym.Env, config: Config, *layers: Mapping[str, Any]) -> Config:
    """The config with the discretizer that a discrete space has, where none was asked for."""
    if config.discretizer == "round" and components(env.observation_space) is not None:
        # A wrapper may have made a box discrete, for which the preset's scale means nothing; one asked for is refused.
        asked = any("scale" in layer for layer in layers)
        return config.replace(discretizer="identity", scale=config.scale if asked else ())
    return config


def _features(env: gym.Env, config: Config, choices: Actions) -> Features:
    if config.discretizer == "identity":
        return cells(env, choices)
    if config.discretizer == "round":
        return grid(env, config.scale, choices)
    filled = config.replace(**defaults(vars(config)))
    return tiling(env, filled, choices) if config.discretizer == "tiles" else bins(env, filled, choices)


def _complete(config: Config, table: Features, backend: str, steps: int | None) -> Config:
    changes: dict[str, Any] = defaults(vars(config))
    changes |= {"backend": backend, "max_episode_steps": steps or UNLIMITED_MAX_EPISODE_STEPS}
    if config.seed is None:
        changes["seed"] = int(np.random.SeedSequence().generate_state(1)[0])
    if isinstance(table, Tiling):
        changes |= {"low": tuple(table.edges[0].tolist()), "high": tuple(table.edges[1].tolist())}
        changes["tiles"] = table.tiles
    if isinstance(table, Bins) and table.limits is not None:
        changes |= {name: tuple(limit.tolist()) for name, limit in zip(("low", "high"), table.limits, strict=True)}
        changes["bins"] = table.shape[:-1]
    if isinstance(config.initial_q, np.ndarray):
        count = n_tables(config.algorithm)
        shape = table.shape if count == 1 else (count, *table.shape)
        if config.initial_q.shape == table.shape and count > 1:
            changes["initial_q"] = np.stack([config.initial_q] * count)
        elif config.initial_q.shape not in (shape, (count, table.rows, table.actions)):
            raise ValueError(f"initial_q must have the table's shape {shape}, got {config.initial_q.shape}")
        elif len(np.unique(np.isneginf(config.initial_q.reshape(count, -1)), axis=0)) > 1:
            raise ValueError("initial_q must have -inf in both tables or in none, got it in one")
    return config.replace(**changes)


def limit(resolved: Resolved) -> str:
    """Returns what there is to say where the time limit is ours (``resolved.limited``)."""
    config = resolved.config
    return f"{config.env} has no time limit of its own: an episode ends after {config.max_episode_steps:,} steps"


def log_default_limit(resolved: Resolved) -> None:
    """Says that the time limit is ours, where it is: once a process for each environment."""
    if resolved.limited and resolved.config.env not in _limited:
        _limited.add(resolved.config.env)
        _LOGGER.warning("%s; max_episode_steps= sets another", limit(resolved))
