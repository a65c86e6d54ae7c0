"""TD(λ), on and off policy, and true online TD(λ) in plain NumPy (Sutton & Barto, 2nd ed., chapter 12)."""

import numpy as np

from qtab._utils.checks import required
from qtab.prediction.reference.common import Prediction


def td_lambda(prediction: Prediction) -> None:
    """Z <- ρ (γλ z + x), then w <- w + α δ z (equations 12.23 to 12.25); on policy ρ is 1 (the box in section 12.2)."""
    decay = prediction.discount * required("trace_decay", prediction.settings.trace_decay)
    for episode in prediction.episodes():
        z = np.zeros_like(prediction.w)
        for visit in episode:
            z *= decay
            for row, x in prediction.features(visit.state):
                z[row] += x
            z *= visit.ratio
            prediction.w += prediction.steps() * prediction.error(visit) * z


def true_online_td_lambda(prediction: Prediction) -> None:
    """W <- w + α (δ + V - V_old) z - α (V - V_old) x with the dutch trace z (the box in section 12.5).

    If weights have different step sizes, α zᵀx in the trace is Σ α z x.
    """
    decay = prediction.discount * required("trace_decay", prediction.settings.trace_decay)
    for episode in prediction.episodes():
        z, old_value = np.zeros_like(prediction.w), 0.0
        for visit in episode:
            features, alpha = prediction.features(visit.state), prediction.steps()
            value, next_value = prediction.value(visit.state), prediction.next_value(visit)
            delta = visit.reward + prediction.discount * next_value - value
            if prediction.is_weighted:
                kept = 1.0 - decay * prediction.dot(alpha * z, visit.state)
            else:
                overlap = 0.0
                for row, _ in features:
                    overlap += float(z[row])
                kept = 1.0 - float(alpha) * decay * overlap
            z *= decay
            for row, x in features:
                z[row] += kept * x
            prediction.w += alpha * (delta + (value - old_value)) * z
            steps = np.broadcast_to(alpha, z.shape)
            for row, x in features:
                prediction.w[row] -= steps[row] * (value - old_value) * x
            old_value = next_value
