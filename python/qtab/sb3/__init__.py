"""Stable-Baselines3 on this package's vector environments.

    from stable_baselines3 import PPO

    model = PPO("MlpPolicy", qtab.sb3.VecEnv("CartPole-v1", num_envs=8), seed=0).learn(100_000)

The other direction needs no adapter: ``evaluate_policy(run, env)`` of Stable-Baselines3 accepts a :class:`qtab.Run`,
whose ``predict`` has the signature of Stable-Baselines3's models.
"""

from typing import TYPE_CHECKING

__all__ = ["VecEnv"]

if TYPE_CHECKING:
    from qtab.sb3.vec_env import VecEnv as VecEnv
else:

    def __getattr__(name):
        if name != "VecEnv":
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        try:
            from qtab.sb3.vec_env import VecEnv
        except ModuleNotFoundError as error:
            from qtab._utils.extras import missing

            raise missing(error, "sb3") from None
        return VecEnv


def __dir__() -> list[str]:
    return sorted([*__all__, *(name for name in globals() if name.startswith("__"))])
