"""Batch TD(0) in plain NumPy (Sutton & Barto, 2nd ed., section 6.3)."""

import numpy as np

from qtab.prediction.reference.common import Prediction

SETTLED = 1e-12
"""Values have settled when no error exceeds this fraction of the largest sum of its terms' magnitudes so far."""


def batch_td(prediction: Prediction) -> None:
    """After each episode, presents all transitions so far repeatedly until the values settle."""
    w = prediction.w
    counts: dict[tuple[int, float, int | None], float] = {}
    visits = np.zeros_like(w)
    for episode in prediction.episodes():
        for visit in episode:
            [row], [following] = prediction.rows[visit.state], prediction.rows[visit.next_state]
            transition = row, visit.reward, None if visit.terminal else following
            counts[transition] = counts.get(transition, 0.0) + 1.0
            visits[row] += 1.0
        largest_sizes = np.zeros_like(w)
        while True:
            errors, sizes = np.zeros_like(w), np.zeros_like(w)
            for (row, reward, next_row), count in counts.items():
                next_value = 0.0 if next_row is None else w[next_row]
                bootstrap = prediction.discount * next_value
                errors[row] += count * (reward + bootstrap - w[row])
                sizes[row] += count * (abs(reward) + abs(bootstrap) + abs(w[row]))
            seen = visits > 0.0
            w[seen] += errors[seen] / visits[seen]
            largest_sizes = np.maximum(largest_sizes, sizes)
            if (np.abs(errors[seen]) <= SETTLED * largest_sizes[seen]).all():
                break
