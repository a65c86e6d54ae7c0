"""Tic-tac-toe against a player that moves at random."""

from typing import Any

import gymnasium as gym
import numpy as np

import qtab

LINES = ((0, 1, 2), (3, 4, 5), (6, 7, 8), (0, 3, 6), (1, 4, 7), (2, 5, 8), (0, 4, 8), (2, 4, 6))


class TicTacToe(qtab.FunctionalEnv):
    """The state is the board: 0 for an empty square, 1 for the agent's, 2 for the opponent's. Free squares only."""

    observation_space = gym.spaces.MultiDiscrete([3] * 9)
    action_space = gym.spaces.Discrete(9)
    metadata = {"render_modes": ["ansi"]}  # noqa: RUF012

    def initial_state(self, rng: np.random.Generator) -> Any:
        return np.zeros(9, np.int64)

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        if state[action] != 0:
            raise ValueError("the square is taken")
        board = state.copy()
        board[action] = 1
        if self._has_won(board, 1):
            return board, 1.0, True
        free = (board == 0).sum()
        if free == 0:
            return board, 0.0, True
        move = rng.integers(0, free)
        for square in range(9):
            if board[square] == 0:
                if move == 0:
                    board[square] = 2
                    break
                move -= 1
        if self._has_won(board, 2):
            return board, -1.0, True
        return board, 0.0, False

    def observe(self, state: Any) -> Any:
        return state

    def action_mask(self, state: Any) -> Any:
        return state == 0

    def render(self, state: Any) -> str:  # type: ignore[override]  # Gymnasium's has no state
        return "\n".join("".join(".xo"[square] for square in row) for row in state.reshape(3, 3))

    def _has_won(self, board: Any, player: int) -> bool:
        for a, b, c in LINES:  # noqa: SIM110 - any() is not compiled
            if board[a] == player and board[b] == player and board[c] == player:
                return True
        return False
