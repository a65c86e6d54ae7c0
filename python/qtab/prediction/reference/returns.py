"""Methods that learn from whole episodes, in plain NumPy: Monte Carlo, the λ-return, importance sampling.

Sutton & Barto, 2nd ed., chapters 5, 6 and 12.
"""

import numpy as np

from qtab._utils.checks import required
from qtab.prediction.reference.common import Prediction, Visit


def monte_carlo(prediction: Prediction) -> None:
    """After an episode, V(S) <- V(S) + α [G - V(S)] for every visit, or the first of each state.

    Equation 6.1 and the box in section 5.1.
    """
    for episode in prediction.episodes():
        visits = list(episode)
        seen: set[int] = set()
        for visit, G in zip(visits, lambda_returns(prediction, visits, 1.0), strict=True):
            if visit.state not in seen or not prediction.settings.first_visit:
                prediction.update(visit.state, G)
            seen.add(visit.state)


def importance_sampling(prediction: Prediction) -> None:
    """Averages of ρ G (ordinary), or averages of G weighted by ρ (equations 5.5 to 5.8)."""
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


def offline_lambda_return(prediction: Prediction) -> None:
    """After an episode, V(S) <- V(S) + α [G - V(S)] with the λ-returns G from the values before the updates.

    Equations 12.2 to 12.4.
    """
    trace_decay = required("trace_decay", prediction.settings.trace_decay)
    for episode in prediction.episodes():
        visits = list(episode)
        for visit, G in zip(visits, lambda_returns(prediction, visits, trace_decay), strict=True):
            prediction.update(visit.state, G)


def lambda_returns(prediction: Prediction, visits: list[Visit], trace_decay: float) -> list[float]:
    """Returns G = R + γ [(1 - λ) V(S') + λ G'] of each step; with λ = 1 the return.

    The returns of a truncated episode end with the value of its last state.
    """
    returns: list[float] = []
    for visit in reversed(visits):
        value = prediction.next_value(visit)
        later = returns[-1] if returns else value
        if trace_decay != 1.0:
            later = (1.0 - trace_decay) * value + trace_decay * later
        returns.append(visit.reward + prediction.discount * later)
    return returns[::-1]
