"""Gymnasium's classic control with the physics step in Rust: ``qtab/MountainCar-v0`` and the others."""

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


class ClassicControlMixin(_core.Physics):
    """The base of an environment that steps in Rust; Gymnasium's class comes after it.

    Spaces, reset options, rendering and attributes are Gymnasium's own. Whatever Gymnasium lets a user assign is
    honoured from the next step on, in a class from the next reset on. CartPole, Acrobot and Pendulum call NumPy's sine
    and cosine: where those are not the platform's, they step in Gymnasium's own code, and its logger says so once.
    """

    model: str
    """The name of the physics in Rust."""

    def __setattr__(self, name: str, value: Any) -> None:
        super().__setattr__(name, value)
        self.changed()

    def __delattr__(self, name: str) -> None:
        super().__delattr__(name)
        self.changed()

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Draws the first state in Rust, from the environment's own generator; by ``options`` in Gymnasium's code."""
        if options is None:
            gym.Env.reset(self, seed=seed)  # type: ignore[arg-type]
            begun = self.begin()
            if begun is not None:
                return begun
            seed = None  # it has been heeded
        theirs: Any = super(_core.Physics, self)
        first: tuple[NDArray[np.float32], dict[str, Any]] = theirs.reset(seed=seed, options=options)
        return first

    def step_in_python(self, action: Any) -> Any:
        """Steps through Gymnasium's own code what Rust does not stand for, such as a float32 state.

        Raises:
            gymnasium.error.ResetNeeded: before the first reset, where Gymnasium has no error of its own.
        """
        try:
            return super(_core.Physics, self).step(action)  # type: ignore[misc]
        except (AttributeError, TypeError):
            if getattr(self, "state", None) is None:
                raise ResetNeeded("Cannot call env.step() before calling env.reset()") from None
            raise

    def __getstate__(self) -> dict[str, Any]:
        """All that a copy needs: Python's attributes, and the state, which lives in Rust."""
        return {**self.__dict__, **({"state": self.state} if hasattr(self, "state") else {})}

    def __setstate__(self, attributes: dict[str, Any]) -> None:
        for name, value in attributes.items():
            setattr(self, name, value)


class MountainCarEnv(ClassicControlMixin, GymnasiumMountainCarEnv):
    """Gymnasium's MountainCar-v0 with its physics step in Rust, equal to the last bit."""

    model = "MountainCar"


class ContinuousMountainCarEnv(ClassicControlMixin, GymnasiumContinuousMountainCarEnv):
    """Gymnasium's MountainCarContinuous-v0 with its physics step in Rust, equal to the last bit."""

    model = "ContinuousMountainCar"


class CartPoleEnv(ClassicControlMixin, GymnasiumCartPoleEnv):
    """Gymnasium's CartPole with its physics step in Rust, equal to the last bit."""

    model = "CartPole"


class AcrobotEnv(ClassicControlMixin, GymnasiumAcrobotEnv):
    """Gymnasium's Acrobot-v1 with its physics step in Rust, equal to the last bit."""

    model = "Acrobot"


class PendulumEnv(ClassicControlMixin, GymnasiumPendulumEnv):
    """Gymnasium's Pendulum-v1 with its physics step in Rust, equal to the last bit."""

    model = "Pendulum"
