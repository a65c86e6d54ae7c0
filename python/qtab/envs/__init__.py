"""Gymnasium environments whose transitions are computed in Rust; everything else is inherited from Gymnasium."""

import gymnasium as gym

from qtab.envs.registry import ENTRIES, EXTRA, PREFIX
from qtab.envs.spec_kwargs import SpecKwargs


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
