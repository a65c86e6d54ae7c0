"""Monte Carlo prediction in plain NumPy (Sutton & Barto, 2nd ed., equation 6.1 and the box in section 5.1)."""

from qtab.prediction.reference.common import Prediction, Visit


def monte_carlo(prediction: Prediction) -> None:
    """After an episode, V(S) <- V(S) + α [G - V(S)] for every visit, or the first of each state."""
    for episode in prediction.episodes():
        visits = list(episode)
        seen: set[int] = set()
        for visit, G in zip(visits, returns_of(prediction, visits), strict=True):
            if visit.state not in seen or not prediction.settings.first_visit:
                prediction.update(visit.state, G)
            seen.add(visit.state)


def returns_of(prediction: Prediction, visits: list[Visit]) -> list[float]:
    """Returns G of each step; a truncated episode continues with the value of its last state."""
    G = prediction.next_value(visits[-1])
    returns = []
    for visit in reversed(visits):
        G = visit.reward + prediction.discount * G
        returns.append(G)
    return returns[::-1]
