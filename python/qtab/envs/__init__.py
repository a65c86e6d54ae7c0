"""Gymnasium environments whose transitions are computed in Rust; everything else is inherited from Gymnasium."""

from typing import Any

import gymnasium as gym

from qtab.envs.registry import ENTRIES, EXTRA, PREFIX


def register() -> None:
    """Registers every environment of this package with Gymnasium.

    Each id of :data:`~qtab.envs.registry.ENTRIES` gets a twin with the prefix ``qtab/`` and the same time limit, reward
    threshold and keyword arguments. Ids that the installed Gymnasium does not have are skipped. The vector environment
    of a twin equals ``SyncVectorEnv``; for CartPole it equals Gymnasium's ``CartPoleVectorEnv``.
    """
    for name, entry in ENTRIES.items():
        spec = gym.registry.get(name)
        if spec is None:
            continue
        gym.register(
            id=PREFIX + name,
            entry_point=entry.entry_point,
            vector_entry_point=entry.vector_entry_point or f"qtab.envs.make_vector:{name}",
            max_episode_steps=spec.max_episode_steps,
            reward_threshold=spec.reward_threshold,
            nondeterministic=spec.nondeterministic,
            kwargs=dict(spec.kwargs) if entry.vector_entry_point else SpecKwargs(spec.kwargs),
        )
    for name, entry in EXTRA.items():
        gym.register(id=name, entry_point=entry.entry_point)


_PASSED_ON = ("vector_kwargs", "wrappers")
_DEFAULT_MODES = (None, "vector_entry_point")
_UNKNOWN = "unknown"


class SpecKwargs(dict[str, Any]):
    """The keyword arguments of a spec whose vector entry point takes ``wrappers`` and ``vector_kwargs``.

    ``gymnasium.make_vec`` pops both from the spec's keyword arguments, with its own arguments as defaults, and raises
    an error for them if it calls a vector entry point. Here they stay, so that they reach the entry point instead.
    With ``vectorization_mode="sync"`` or ``"async"``, and in all other respects, this is a plain dict.
    """

    _mode: Any = _UNKNOWN
    """The vectorization mode, which ``make_vec`` pops before these two."""

    def pop(self, key: str, *default: Any) -> Any:
        """Removes a key and returns its value; ``wrappers`` and ``vector_kwargs`` can stay."""
        value = super().pop(key, *default)
        if key == "vectorization_mode":
            self._mode = getattr(value, "value", value)
        elif key in _PASSED_ON and value and self._mode in _DEFAULT_MODES:
            self[key] = value
            return type(value)()
        return value

    def copy(self) -> "SpecKwargs":
        """Returns a copy, with which a spec makes the vector environment again."""
        return SpecKwargs(self)
