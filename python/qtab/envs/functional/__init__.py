"""Environments written as functions of their state: :class:`qtab.FunctionalEnv`."""

from qtab.envs.functional.functional_env import FunctionalEnv

__all__ = ["FunctionalEnv"]
