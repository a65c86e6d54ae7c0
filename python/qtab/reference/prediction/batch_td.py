"""Batch TD(0) in plain NumPy (Sutton & Barto, 2nd ed., section 6.3)."""

import numpy as np

from qtab.reference.prediction.common import Prediction

SETTLED = 1e-12
"""The largest change, as a fraction of the largest value or reward so far, at which values have settled."""


def batch_td(prediction: Prediction) -> None:
    """After each episode, presents all transitions so far again and again until the values settle."""
    w = prediction.w
    counts: dict[tuple[int, float, int | None], float] = {}
    visits, scale = np.zeros_like(w), 0.0
    for episode in prediction.episodes():
        for visit in episode:
            [row], [following] = prediction.rows[visit.state], prediction.rows[visit.next_state]
            transition = row, visit.reward, None if visit.terminal else following
            counts[transition] = counts.get(transition, 0.0) + 1.0
            visits[row] += 1.0
        scale = max(scale, np.abs(w).max(), *(abs(reward) for _, reward, _ in counts))
        while True:
            errors = np.zeros_like(w)
            for (row, reward, next_row), count in counts.items():
                next_value = 0.0 if next_row is None else w[next_row]
                errors[row] += count * (reward + prediction.discount * next_value - w[row])
            seen = visits > 0.0
            increments = errors[seen] / visits[seen]
            w[seen] += increments
            scale = max(scale, np.abs(w[seen]).max())
            if np.abs(increments).max() <= SETTLED * scale:
                break
