"""Environments that change with time."""

import gymnasium as gym


def continue_after(env: gym.Env, steps: int) -> None:
    """Tells an environment that changes with time how many steps were taken, by its method ``resume_after``."""
    resume_after = getattr(env.unwrapped, "resume_after", None)
    if callable(resume_after):
        resume_after(steps)
