"""``gymnasium.make_vec("qtab/CartPole-v1")``: Gymnasium's ``CartPoleVectorEnv`` with its physics in Rust."""

from typing import Any

import numpy as np
from gymnasium.envs.classic_control.cartpole import CartPoleVectorEnv as GymnasiumCartPoleVectorEnv
from numpy.typing import NDArray

from qtab import _core

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
