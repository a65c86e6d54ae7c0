"""What the environments of a table share."""

from typing import Any

import gymnasium as gym


class RustReset:
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
