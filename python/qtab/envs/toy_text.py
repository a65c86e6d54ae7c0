"""Gymnasium's toy text environments with resets and steps in Rust: ``qtab/FrozenLake-v1`` and the others."""

from typing import Any

import gymnasium as gym
from gymnasium.envs.toy_text.blackjack import BlackjackEnv as GymnasiumBlackjackEnv
from gymnasium.envs.toy_text.cliffwalking import CliffWalkingEnv as GymnasiumCliffWalkingEnv
from gymnasium.envs.toy_text.frozen_lake import FrozenLakeEnv as GymnasiumFrozenLakeEnv
from gymnasium.envs.toy_text.taxi import TaxiEnv as GymnasiumTaxiEnv

from qtab import _core


class ToyTextMixin:
    """Mixin that resets a toy text environment in Rust; a class of the extension module precedes it in the bases.

    ``_native_reset``, which that class defines, draws the first state from ``np_random`` and returns the result of
    ``reset``. It calls ``_reset_in_python`` if Rust does not support the distribution of first states.
    """

    _native_reset: Any

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[int, dict[str, Any]]:
        """Draws the first state; ``options`` are ignored, as in Gymnasium."""
        gym.Env.reset(self, seed=seed, options=options)  # type: ignore[arg-type]
        first: tuple[int, dict[str, Any]] = self._native_reset()
        return first


class FrozenLakeEnv(_core.ToyText, ToyTextMixin, GymnasiumFrozenLakeEnv):
    """Gymnasium's FrozenLake stepped in Rust; changes to its table ``P`` take effect at the next step."""

    _reset_in_python = GymnasiumFrozenLakeEnv.reset
    _step_in_python = GymnasiumFrozenLakeEnv.step


class CliffWalkingEnv(_core.ToyText, ToyTextMixin, GymnasiumCliffWalkingEnv):
    """Gymnasium's CliffWalking stepped in Rust; changes to its table ``P`` take effect at the next step."""

    _reset_in_python = GymnasiumCliffWalkingEnv.reset
    _step_in_python = GymnasiumCliffWalkingEnv.step


class TaxiEnv(_core.Taxi, ToyTextMixin, GymnasiumTaxiEnv):
    """Gymnasium's Taxi stepped in Rust, with the fickle passenger and the action mask.

    Changes to its table ``P`` take effect at the next step.
    """

    _reset_in_python = GymnasiumTaxiEnv.reset
    _step_in_python = GymnasiumTaxiEnv.step
    _action_mask_in_python = GymnasiumTaxiEnv.action_mask


class BlackjackEnv(_core.Blackjack, GymnasiumBlackjackEnv):
    """Gymnasium's Blackjack dealt and stepped in Rust, with cards drawn from ``np_random``."""

    _step_in_python = GymnasiumBlackjackEnv.step

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[tuple[int, int, int], dict[str, Any]]:
        """Deals two cards to the player and two to the dealer; ``options`` are ignored, as in Gymnasium."""
        super(GymnasiumBlackjackEnv, self).reset(seed=seed)
        dealt: tuple[tuple[int, int, int], dict[str, Any]] | None = self._native_reset()
        return super().reset(options=options) if dealt is None else dealt
