"""Monte Carlo prediction in plain NumPy (Sutton & Barto, 2nd ed., equation 6.1 and the box in section 5.1)."""

from qtab.prediction.reference.common import Prediction
from qtab.prediction.reference.offline_lambda_return import lambda_returns


def monte_carlo(prediction: Prediction) -> None:
    """After an episode, V(S) <- V(S) + α [G - V(S)] for every visit, or the first of each state."""
    for episode in prediction.episodes():
        visits = list(episode)
        seen: set[int] = set()
        for visit, G in zip(visits, lambda_returns(prediction, visits, 1.0), strict=True):
            if visit.state not in seen or not prediction.settings.first_visit:
                prediction.update(visit.state, G)
            seen.add(visit.state)
