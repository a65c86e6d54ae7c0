"""``qtab/Blackjack-v1``."""

from typing import Any

from gymnasium.envs.toy_text.blackjack import BlackjackEnv as GymnasiumBlackjackEnv

from qtab import _core


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
