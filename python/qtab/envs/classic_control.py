"""Gymnasium's classic control environments with steps computed in Rust: ``qtab/MountainCar-v0`` and the others.

For ``gymnasium.make_vec("qtab/CartPole-v1")`` there is also Gymnasium's ``CartPoleVectorEnv``.
"""

from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.envs.classic_control.acrobot import AcrobotEnv as GymnasiumAcrobotEnv
from gymnasium.envs.classic_control.cartpole import CartPoleEnv as GymnasiumCartPoleEnv
from gymnasium.envs.classic_control.cartpole import CartPoleVectorEnv as GymnasiumCartPoleVectorEnv
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


_SURFACES = ("screens", "surf")


class CartPoleVectorEnv(GymnasiumCartPoleVectorEnv):
    """Gymnasium's ``CartPoleVectorEnv``, equal to the last bit, with the cart-poles stepped in Rust.

    Gymnasium has a special vector environment for CartPole. All its cart-poles draw from one generator, so that their
    first states differ from those of ``SyncVectorEnv``, and its rewards are float32. Its attributes (``state``,
    ``steps``, ``gravity``, …) can be read and assigned. :class:`qtab.RustVectorEnv` equals ``SyncVectorEnv``.

    Steps that Rust does not support (a state of another dtype, a parameter that is not a Python number, numbers so
    large that NumPy warns) run in Gymnasium's code, as do all steps if NumPy does not take sine and cosine from the C
    library.

    Args:
        num_envs: The number of cart-poles.
        max_episode_steps: The time limit of an episode, in steps.
        render_mode: None, or anything else for ``render`` to return a list of frames.
        sutton_barto_reward: Whether the reward is -1 in the last step and 0 before it, instead of 1 per step.
        others: Must be empty: arguments of :class:`qtab.RustVectorEnv` raise an error that names it.

    Raises:
        TypeError: for any other argument.
    """

    def __init__(
        self,
        num_envs: int = 1,
        max_episode_steps: int = 500,
        render_mode: str | None = None,
        sutton_barto_reward: bool = False,
        **others: Any,
    ) -> None:
        if others:
            name = next(iter(others))
            raise TypeError(
                f"{name} must be left out, as for Gymnasium's CartPoleVectorEnv, got {others[name]!r}; "
                "qtab.RustVectorEnv('CartPole-v1', ...), which equals SyncVectorEnv, takes autoreset_mode, copy and "
                "threads"
            )
        super().__init__(num_envs, max_episode_steps, render_mode, sutton_barto_reward)

    def step(
        self, action: Any
    ) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """Steps every cart-pole; those whose episode ended in the step before are reset instead.

        Raises:
            AssertionError: from Gymnasium, for an action outside the space, or before the first reset.
        """
        old_state: Any = self.state
        arrays = type(old_state) is np.ndarray and type(action) is np.ndarray
        stepped = _core.step_cart_poles(self, old_state, action, self.prev_done) if arrays else None
        if stepped is None:
            return super().step(action)
        state, rewards, terminated, over = stepped
        self.state: Any = state
        self.steps += 1
        truncated = self.steps >= self.max_episode_steps
        if len(over):
            state[:, over] = self.np_random.uniform(low=self.low, high=self.high, size=(4, len(over)))
            self.steps[over] = 0
            truncated[over] = False
        self.prev_done = np.logical_or(terminated, truncated)
        return state.T.astype(np.float32), rewards, terminated, truncated, {}

    def __getstate__(self) -> dict[str, Any]:
        """Returns all attributes but the surfaces, which the next frame creates again."""
        return {name: None if name in _SURFACES else value for name, value in self.__dict__.items()}
