"""Vector environments: ``RustVectorEnv``, and the one in Python that it falls back to."""

from qtab.envs.vector.rust_vector_env import RustVectorEnv

__all__ = ["RustVectorEnv"]
