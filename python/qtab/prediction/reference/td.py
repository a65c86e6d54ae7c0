"""TD(0), n-step TD and batch TD(0) in plain NumPy (Sutton & Barto, 2nd ed., chapters 6 and 7)."""

import numpy as np

from qtab._utils.checks import required
from qtab.prediction.reference.common import Prediction, Visit

SETTLED = 1e-12
"""Values have settled when no error exceeds this fraction of the largest sum of its terms' magnitudes so far."""


def td(prediction: Prediction) -> None:
    """V(S) <- V(S) + α [R + γ V(S') - V(S)] after every step (equation 6.2)."""
    for episode in prediction.episodes():
        for visit in episode:
            prediction.update(visit.state, visit.reward + prediction.discount * prediction.next_value(visit))


def n_step_td(prediction: Prediction) -> None:
    """V(S(τ)) <- V(S(τ)) + α [G - V(S(τ))] with n rewards in G (the box in section 7.1)."""
    n = required("n_steps", prediction.settings.n_steps)
    for episode in prediction.episodes():
        visits: list[Visit] = []
        tau = 0
        for visit in episode:
            visits.append(visit)
            while tau <= len(visits) - n or (visit.over and tau < len(visits)):
                G, power = 0.0, 1.0
                for later in visits[tau : tau + n]:
                    G += power * later.reward
                    power *= prediction.discount
                if not visit.terminal:
                    G += power * prediction.value(visit.next_state)
                prediction.update(visits[tau].state, G)
                tau += 1


def batch_td(prediction: Prediction) -> None:
    """After each episode, presents all transitions so far repeatedly until the values settle (section 6.3)."""
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
