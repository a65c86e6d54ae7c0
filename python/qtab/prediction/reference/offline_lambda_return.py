"""The off-line λ-return algorithm in plain NumPy (Sutton & Barto, 2nd ed., equations 12.2 to 12.4)."""

from qtab._utils.checks import required
from qtab.prediction.reference.common import Prediction, Visit


def offline_lambda_return(prediction: Prediction) -> None:
    """After an episode, V(S) <- V(S) + α [G - V(S)] with the λ-returns G from the values before the updates."""
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
