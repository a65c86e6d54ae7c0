"""n-step TD prediction in plain NumPy (Sutton & Barto, 2nd ed., the box in section 7.1)."""

from qtab._utils.checks import required
from qtab.prediction.reference.common import Prediction, Visit


def n_step_td(prediction: Prediction) -> None:
    """V(S(τ)) <- V(S(τ)) + α [G - V(S(τ))] with n rewards in G."""
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
