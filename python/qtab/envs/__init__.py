"""The environments as Gymnasium makes them: physics in Rust, all the rest inherited."""

import gymnasium as gym

from qtab.envs.registry import ENTRIES, EXTRA, PREFIX


def register() -> None:
    """Registers ``qtab/…`` beside each of Gymnasium's environments that Rust knows, with its limit and threshold."""
    for name, model in ENTRIES.items():
        theirs = gym.registry.get(name)
        if theirs is None:  # an old version that this Gymnasium no longer has
            continue
        gym.register(
            id=PREFIX + name,
            entry_point=model.qtab,
            vector_entry_point=f"qtab.envs.vector:{name}",
            max_episode_steps=theirs.max_episode_steps,
            reward_threshold=theirs.reward_threshold,
            nondeterministic=theirs.nondeterministic,
            kwargs=dict(theirs.kwargs),
        )
    for name, model in EXTRA.items():
        gym.register(id=name, entry_point=model.qtab)
