"""TD(0) in plain NumPy (Sutton & Barto, 2nd ed., equation 6.2)."""

from qtab.prediction.reference.common import Prediction


def td(prediction: Prediction) -> None:
    """V(S) <- V(S) + α [R + γ V(S') - V(S)] after every step."""
    for episode in prediction.episodes():
        for visit in episode:
            prediction.update(visit.state, visit.reward + prediction.discount * prediction.next_value(visit))
