"""Off-policy Monte Carlo prediction in plain NumPy (Sutton & Barto, 2nd ed., equations 5.5 to 5.8)."""

import numpy as np

from qtab.prediction.reference.common import Prediction
from qtab.prediction.reference.offline_lambda_return import lambda_returns


def importance_sampling(prediction: Prediction) -> None:
    """Averages of ρ G (ordinary), or averages of G weighted by ρ."""
    settings = prediction.settings
    C = np.zeros_like(prediction.w)
    for episode in prediction.episodes():
        visits = list(episode)
        returns = lambda_returns(prediction, visits, 1.0)
        states = [visit.state for visit in visits]
        rho = 1.0
        for t in reversed(range(len(visits))):
            state = states[t]
            rho *= visits[t].ratio
            if settings.first_visit and state in states[:t]:
                continue
            [row] = prediction.rows[state]
            if not settings.weighted:
                C[row] += 1.0
                prediction.w[row] += (rho * returns[t] - prediction.w[row]) / C[row]
            elif rho != 0.0:
                C[row] += rho
                prediction.w[row] += rho / C[row] * (returns[t] - prediction.w[row])
