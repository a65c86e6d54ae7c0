"""The off-line λ-return algorithm in plain NumPy (Sutton & Barto, 2nd ed., equations 12.2 to 12.4)."""

from qtab._utils.checks import required
from qtab.prediction.reference.common import Prediction


def offline_lambda_return(prediction: Prediction) -> None:
    """After an episode, V(S) <- V(S) + α [G - V(S)] with the λ-returns G from the values before."""
    trace_decay = required("trace_decay", prediction.settings.trace_decay)
    for episode in prediction.episodes():
        visits = list(episode)
        returns: list[float] = []
        # G = R + γ [(1 - λ) V(S') + λ G'], from the last step to the first.
        for visit in reversed(visits):
            value = prediction.next_value(visit)
            later = returns[-1] if returns else value
            if trace_decay != 1.0:
                later = (1.0 - trace_decay) * value + trace_decay * later
            returns.append(visit.reward + prediction.discount * later)
        for visit, G in zip(visits, reversed(returns), strict=True):
            prediction.update(visit.state, G)
