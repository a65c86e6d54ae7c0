"""Gymnasium's toy text with its draws and steps in Rust: ``qtab/FrozenLake-v1`` and the others."""

from typing import Any

import gymnasium as gym
from gymnasium.envs.toy_text.blackjack import BlackjackEnv as GymnasiumBlackjackEnv
from gymnasium.envs.toy_text.cliffwalking import CliffWalkingEnv as GymnasiumCliffWalkingEnv
from gymnasium.envs.toy_text.frozen_lake import FrozenLakeEnv as GymnasiumFrozenLakeEnv
from gymnasium.envs.toy_text.taxi import TaxiEnv as GymnasiumTaxiEnv

from qtab import _core


class ToyTextMixin:
    """The base of an environment that begins an episode in Rust, its draws from its own generator.

    ``begin`` draws the first state and returns what a reset returns; where Rust does not stand for the distribution as
    it is, it calls ``reset_in_python``.
    """

    begin: Any

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[int, dict[str, Any]]:
        """Draws the first state; ``options`` has none, as in Gymnasium."""
        gym.Env.reset(self, seed=seed, options=options)  # type: ignore[arg-type]
        first: tuple[int, dict[str, Any]] = self.begin()
        return first


class FrozenLakeEnv(_core.Table, ToyTextMixin, GymnasiumFrozenLakeEnv):
    """Gymnasium's FrozenLake stepping in Rust by its own table ``P``, as it stands at each step."""

    reset_in_python = GymnasiumFrozenLakeEnv.reset
    step_in_python = GymnasiumFrozenLakeEnv.step


class CliffWalkingEnv(_core.Table, ToyTextMixin, GymnasiumCliffWalkingEnv):
    """Gymnasium's CliffWalking stepping in Rust by its own table ``P``, as it stands at each step."""

    reset_in_python = GymnasiumCliffWalkingEnv.reset
    step_in_python = GymnasiumCliffWalkingEnv.step


class TaxiEnv(_core.Taxi, ToyTextMixin, GymnasiumTaxiEnv):
    """Gymnasium's Taxi stepping in Rust by its own table ``P``, its fickle passenger and its action mask included."""

    reset_in_python = GymnasiumTaxiEnv.reset
    step_in_python = GymnasiumTaxiEnv.step
    action_mask_in_python = GymnasiumTaxiEnv.action_mask


class BlackjackEnv(_core.Blackjack, GymnasiumBlackjackEnv):
    """Gymnasium's Blackjack dealing and stepping in Rust, its cards from the environment's own generator."""

    step_in_python = GymnasiumBlackjackEnv.step

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[tuple[int, int, int], dict[str, Any]]:
        """Deals anew."""
        super(GymnasiumBlackjackEnv, self).reset(seed=seed)
        dealt: tuple[tuple[int, int, int], dict[str, Any]] | None = self.deal()
        return super().reset(options=options) if dealt is None else dealt
