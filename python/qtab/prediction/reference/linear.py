"""Methods for linear values: off-policy TD, gradient TD, emphatic TD and least-squares TD.

Sutton & Barto, 2nd ed., sections 9.8, 11.2, 11.7 and 11.8. The updates are those of
:mod:`qtab.prediction.reference.off_policy` and :class:`qtab.prediction.LSTD`.
"""

from qtab._utils.checks import required
from qtab.prediction.linear.lstd import LSTD
from qtab.prediction.reference.common import Prediction, Visit
from qtab.prediction.reference.off_policy import GTD2, TDC, EmphaticTD, OffPolicyUpdate, SemiGradientTD, Vector


def off_policy_td(prediction: Prediction) -> None:
    """W <- w + α ρ δ x (equation 11.2)."""
    _learn(prediction, SemiGradientTD)


def gtd2(prediction: Prediction) -> None:
    """W <- w + α ρ (x - γ x') xᵀv, v <- v + β ρ (δ - vᵀx) x (R. Sutton and others, 2009; section 11.7)."""
    _learn(prediction, GTD2)


def tdc(prediction: Prediction) -> None:
    """W <- w + α ρ (δ x - γ x' xᵀv), v <- v + β ρ (δ - vᵀx) x (R. Sutton and others, 2009; section 11.7)."""
    _learn(prediction, TDC)


def emphatic_td(prediction: Prediction) -> None:
    """M <- γ ρ M + 1, w <- w + α M ρ δ x (R. Sutton, A. Mahmood and M. White, 2016; section 11.8)."""
    _learn(prediction, EmphaticTD)


def _learn(prediction: Prediction, method: type[OffPolicyUpdate]) -> None:
    beta = prediction.settings.second_learning_rate
    update = method(prediction.w, 0.0, prediction.discount, 0.0 if beta is None else prediction.steps(beta))
    for episode in prediction.episodes():
        update.start_episode()
        for visit in episode:
            update.alpha = prediction.steps()
            error, correction = prediction.error(visit), prediction.dot(update.v, visit.state)
            update.move(*_vectors(prediction, visit), visit.ratio, error, correction)


def lstd(prediction: Prediction) -> None:
    """W = A⁻¹ b after each episode (S. Bradtke and A. Barto, 1996; J. Boyan, 1999; section 9.8)."""
    settings, w = prediction.settings, prediction.w
    least_squares = LSTD(
        len(w),
        prediction.discount,
        trace_decay=required("trace_decay", settings.trace_decay),
        epsilon=required("epsilon", settings.epsilon),
        recursive=required("recursive", settings.recursive),
    )
    for episode in prediction.episodes():
        least_squares.start_episode()
        for visit in episode:
            x, next_x = _vectors(prediction, visit)
            least_squares.update(x, visit.reward, next_x, terminated=visit.terminal)
        w[:] = least_squares.weights


def _vectors(prediction: Prediction, visit: Visit) -> tuple[Vector, Vector]:
    """Returns x and x', which is zero in a terminal state."""
    return prediction.vector(visit.state), prediction.vector(None if visit.terminal else visit.next_state)
