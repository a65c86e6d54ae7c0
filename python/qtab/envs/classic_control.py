"""Gymnasium's classic control environments with steps computed in Rust: ``qtab/MountainCar-v0`` and the others."""

from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.envs.classic_control.acrobot import AcrobotEnv as GymnasiumAcrobotEnv
from gymnasium.envs.classic_control.cartpole import CartPoleEnv as GymnasiumCartPoleEnv
from gymnasium.envs.classic_control.continuous_mountain_car import (
    Continuous_MountainCarEnv as GymnasiumContinuousMountainCarEnv,
)
from gymnasium.envs.classic_control.mountain_car import MountainCarEnv as GymnasiumMountainCarEnv
from gymnasium.envs.classic_control.pendulum import PendulumEnv as GymnasiumPendulumEnv
from gymnasium.error import ResetNeeded
from numpy.typing import NDArray

from qtab import _core


class ClassicControlMixin(_core.ClassicControl):
    """Mixin that steps a classic control environment in Rust; Gymnasium's class follows it in the bases.

    Spaces, reset options, rendering and attributes are inherited from Gymnasium. An attribute assigned on the instance
    takes effect at the next step, one assigned on the class at the next reset. CartPole, Acrobot and Pendulum use
    NumPy's sine and cosine. If NumPy does not take these from the C library, which Rust calls, the environments step
    in Gymnasium's code, and Gymnasium's logger reports it once.
    """

    model: str
    """The registry's name of the environment."""

    def __setattr__(self, name: str, value: Any) -> None:
        super().__setattr__(name, value)
        self.invalidate()

    def __delattr__(self, name: str) -> None:
        super().__delattr__(name)
        self.invalidate()

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Draws the first state in Rust from ``np_random``, or in Gymnasium's code if there are ``options``."""
        if options is None:
            gym.Env.reset(self, seed=seed)  # type: ignore[arg-type]
            first_state = self.native_reset()
            if first_state is not None:
                return first_state
            seed = None  # already applied
        gymnasium_env: Any = super(_core.ClassicControl, self)
        first: tuple[NDArray[np.float32], dict[str, Any]] = gymnasium_env.reset(seed=seed, options=options)
        return first

    def step_in_python(self, action: Any) -> Any:
        """Steps in Gymnasium's code, for states that Rust does not support, such as one of float32.

        Raises:
            gymnasium.error.ResetNeeded: before the first reset.
        """
        try:
            return super(_core.ClassicControl, self).step(action)  # type: ignore[misc]
        except (AttributeError, TypeError):
            if getattr(self, "state", None) is None:
                raise ResetNeeded("Cannot call env.step() before calling env.reset()") from None
            raise

    def __getstate__(self) -> dict[str, Any]:
        """Returns the Python attributes and the state, which Rust holds."""
        return {**self.__dict__, **({"state": self.state} if hasattr(self, "state") else {})}

    def __setstate__(self, attributes: dict[str, Any]) -> None:
        for name, value in attributes.items():
            setattr(self, name, value)


class MountainCarEnv(ClassicControlMixin, GymnasiumMountainCarEnv):
    """Gymnasium's MountainCar-v0 with steps computed in Rust, equal to the last bit."""

    model = "MountainCar"


class ContinuousMountainCarEnv(ClassicControlMixin, GymnasiumContinuousMountainCarEnv):
    """Gymnasium's MountainCarContinuous-v0 with steps computed in Rust, equal to the last bit."""

    model = "ContinuousMountainCar"


class CartPoleEnv(ClassicControlMixin, GymnasiumCartPoleEnv):
    """Gymnasium's CartPole with steps computed in Rust, equal to the last bit."""

    model = "CartPole"


class AcrobotEnv(ClassicControlMixin, GymnasiumAcrobotEnv):
    """Gymnasium's Acrobot-v1 with steps computed in Rust, equal to the last bit."""

    model = "Acrobot"


class PendulumEnv(ClassicControlMixin, GymnasiumPendulumEnv):
    """Gymnasium's Pendulum-v1 with steps computed in Rust, equal to the last bit."""

    model = "Pendulum"
