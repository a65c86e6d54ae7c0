"""``qtab.ValueEstimates``: the estimated values of a policy, for each seed and over the episodes."""

from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import gymnasium as gym
import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab._utils import html
from qtab._utils.checks import required
from qtab._utils.fields import with_fields
from qtab._utils.shown import counted, shown
from qtab.config import Config
from qtab.discretizers import Discretizer
from qtab.prediction import storage
from qtab.prediction.observation_policies import ObservationPolicies
from qtab.prediction.settings import PredictionSettings
from qtab.results.action_values import summed, weighted_sum

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from qtab.plots.parts.subject import Subject
    from qtab.prediction.verification import ValuesVerification


@with_fields
@dataclass(frozen=True, eq=False, repr=False)
class ValueEstimates:
    """The values of a policy as estimated by one method, with one run for each seed."""

    env: str
    """The environment's id, or the name of its class."""
    settings: PredictionSettings
    """The method and its options."""
    seeds: tuple[int, ...]
    """(seeds,): the seed of each run."""
    episodes: NDArray[np.int64]
    """(points,): the numbers of episodes after which the weights were recorded, ascending; the last one is the last
    episode."""
    weights: NDArray[np.float64]
    """(seeds, points, n_weights): the recorded weights, which are the values if the features are a table."""
    rows: NDArray[np.uint32] | None
    """(states, n_active): the active features of each state, whose weights add up to its value; None for feature
    vectors, and with tile coding or weighted features of the observations."""
    probabilities: NDArray[np.float64] | None
    """(*cells, actions): the policy that is evaluated; None if it reads the observations of a Box."""
    behavior: NDArray[np.float64] | None
    """(*cells, actions): the policy that chose the actions: the same, except off policy."""
    config: Config | None = field(repr=False, default=None)
    """The task as a config, for verification; None for estimates from a file."""
    seconds: float = 0.0
    """The wall-clock time of the computation."""
    discretizer: Discretizer | None = field(repr=False, default=None)
    """Maps observations to states, or to the active features; None for estimates of numbered states from a file."""
    policies: ObservationPolicies | None = field(repr=False, default=None)
    """The policies that read the observations of a Box, if they are not tables; None for estimates from a file."""
    feature_vectors: NDArray[np.float64] | None = field(repr=False, default=None)
    """(states, n_weights): the feature vector of each state, whose product with the weights is its value; or None."""
    initial_weights: NDArray[np.float64] | None = field(repr=False, default=None)
    """(n_weights,): the weights before the first episode; None for estimates from a file."""

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the values of a run: the number of cells along each component of the observation.

        Raises:
            ValueError: with tile coding or weighted features of the observations, which have no cells.
        """
        if self.probabilities is not None:
            return self.probabilities.shape[:-1]
        if self.discretizer is None or not self.discretizer.has_cells:
            what = "weighted features do" if self.is_weighted else "tile coding does"
            raise ValueError(f"the values need cells, which {what} not have; value(observation) works instead")
        return self.discretizer.shape

    @property
    def of_cells(self) -> bool:
        """Whether the states are numbered, or cells of the observations, so that their values are an array."""
        return self.rows is not None or self.feature_vectors is not None

    @property
    def is_weighted(self) -> bool:
        """Whether the features have values other than 1: vectors, or a discretizer such as "fourier"."""
        return self.feature_vectors is not None or (self.discretizer is not None and self.discretizer.is_weighted)

    @property
    def n_active(self) -> int:
        """The number of weights that add up to a value."""
        if self.feature_vectors is not None:
            return int(self.feature_vectors.shape[1])
        return required("discretizer", self.discretizer).n_active if self.rows is None else self.rows.shape[1]

    @property
    def values(self) -> NDArray[np.float64]:
        """(seeds, *cells): the values after the last episode.

        Raises:
            ValueError: with tile coding or weighted features of the observations, which have no cells; :meth:`value`
                works.
        """
        return self.values_after(-1)

    def value(self, observation: Any, point: int = -1) -> NDArray[np.float64]:
        """Returns (seeds,): the value of an observation, or the (seeds, n) values of n observations.

        Args:
            observation: An observation, or n of them.
            point: One of the recorded points, by its index.

        Raises:
            TypeError: if the observation does not hold numbers (integers for a discrete space).
            ValueError: if the observation has another shape than the space, or lies outside it; or for estimates of
                numbered states from a file.
        """
        if self.discretizer is None:
            raise ValueError("value needs the observations of the states, which are not in the file; values works")
        weights, features = self.weights[:, point], self.discretizer.active_features(observation)
        if self.feature_vectors is not None:
            features = self.feature_vectors[features[..., 0]]
        elif self.rows is not None:
            features = self.rows[features[..., 0]]
        if self.is_weighted:
            return np.moveaxis(weighted_sum(features, weights.T), -1, 0)
        return _summed(weights, np.moveaxis(features, -1, 0))

    @property
    def mean(self) -> NDArray[np.float64]:
        """(*cells,): the mean of the final values over the seeds."""
        return np.asarray(self.values.mean(axis=0))

    @property
    def standard_error(self) -> NDArray[np.float64]:
        """(*cells,): the standard error of :attr:`mean`; NaN for a single seed."""
        if len(self.seeds) == 1:
            return np.full(self.shape, np.nan)
        return np.asarray(self.values.std(axis=0, ddof=1) / np.sqrt(len(self.seeds)))

    def values_after(self, point: int) -> NDArray[np.float64]:
        """Returns (seeds, *cells): the values at one of the recorded points, by its index."""
        shape, weights = self.shape, self.weights[:, point]
        if self.feature_vectors is not None:
            return weighted_sum(self.feature_vectors, weights.T).T.reshape(len(self.seeds), *shape)
        return _summed(weights, required("rows", self.rows).T).reshape(len(self.seeds), *shape)

    def rms_error(
        self,
        true_values: ArrayLike | Callable[[Any], float],
        weights: ArrayLike | None = None,
        *,
        observations: ArrayLike | None = None,
    ) -> NDArray[np.float64]:
        """Returns (seeds, points): the root of the weighted mean of the squared errors over states or observations.

        Args:
            true_values: (*cells,): the true values, such as those of :func:`qtab.policy_values`; with ``observations``,
                (n,) true values of these, or a function from an observation to its value.
            weights: (*cells,) or (n,): the weight of each error, such as ``state_distribution`` for the value error VE
                of Sutton & Barto's equation 9.1; None means equal weights.
            observations: The n observations whose values are compared, for states that are not numbered; None means all
                states.

        Raises:
            TypeError: for a function without observations.
            ValueError: if an argument has another shape, or the weights are negative or all zero; or with tile coding
                without observations.
        """
        if observations is None:
            if callable(true_values):
                raise TypeError("true_values must be an array where observations is None, got a function")
            estimated, shape, where = self.values_after, self.shape, "states"
        else:
            at = np.asarray(observations)
            estimated, where = lambda point: self.value(at, point), "observations"
            shape = estimated(-1).shape[1:]
            if len(shape) != 1:
                raise ValueError(f"observations must hold several observations, got an array of shape {at.shape}")
            if callable(true_values):
                true_values = [float(true_values(observation)) for observation in at]
        exact = _of_shape("true_values", true_values, shape, where)
        shares = np.ones(exact.shape) if weights is None else _of_shape("weights", weights, shape, where)
        if not (shares >= 0.0).all() or not shares.sum() > 0.0:
            raise ValueError("weights must be at least 0 and not all 0")
        shares = shares / shares.sum()
        axes = tuple(range(1, exact.ndim + 1))
        with np.errstate(over="ignore"):  # values that diverge have an infinite error
            errors = [
                np.sqrt((shares * (estimated(point) - exact) ** 2).sum(axis=axes))
                for point in range(len(self.episodes))
            ]
        return np.stack(errors, axis=1)

    def verify(
        self, episodes: int | None = None, seed: int | None = None, env: gym.Env | None = None
    ) -> "ValuesVerification":
        """Repeats the estimate in plain NumPy in Gymnasium's environment, and compares the weights byte for byte.

        Args:
            episodes: The number of episodes, one of :attr:`episodes`; None means all.
            seed: One of :attr:`seeds`; None means the first.
            env: The environment, if qtab cannot make it again. It must be that of the estimates, and is not closed.

        Raises:
            gymnasium.error.UnregisteredEnv: without ``env``, for an environment that is not registered.
            TypeError: for an argument of the wrong type.
            ValueError: for a number that was not recorded, another seed, another environment than that of the
                estimates, or, without ``env``, one that cannot be made again.
        """
        from qtab.prediction.verification import verify_values

        return verify_values(self, episodes, seed, env)

    def plot(self, ax: "Axes | None" = None, *, true_values: ArrayLike | None = None) -> "Axes":
        """Draws the mean values over the states, and returns the axes.

        States of one component are a line with a band of two standard errors to each side; states of two or more are
        drawn as in :func:`qtab.plots.values`. Estimates from a file may lack the observations of the states: they are
        then a map of the first two components, with the others at the middle of their range.

        Args:
            ax: The axes to draw on; None creates a new figure.
            true_values: (*cells,): the true values, drawn as a dashed line beside those of one component.

        Raises:
            ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
            ValueError: for ``true_values`` of another shape, or with values that are drawn as a map.
        """
        from qtab.prediction.plot import draw_values

        if true_values is not None and (not self.of_cells or len(self.shape) > 1):
            raise ValueError(f"true_values must be None for values that are drawn as a map, got {shown(true_values)}")
        if not self.of_cells or (self.discretizer is not None and len(self.shape) > 1):
            from qtab.plots import values

            return values(self, ax)
        exact = None if true_values is None else _of_shape("true_values", true_values, self.shape, "states")
        return draw_values(self, ax, exact)

    def _subject(self) -> "Subject":
        """The data that :func:`qtab.plots.values` draws."""
        from qtab.prediction.plot import subject_of_values

        return subject_of_values(self)

    def save(self, path: Path | str) -> None:
        """Writes the estimates to an ``.npz`` file, completely or not at all.

        Raises:
            OSError: if the file cannot be written.
        """
        storage.save(self, path)

    @classmethod
    def load(cls, path: Path | str) -> "ValueEstimates":
        """Reads estimates written by :meth:`save`.

        Raises:
            OSError: if the file is missing or cannot be read.
            ValueError: if the file does not hold value estimates.
        """
        return storage.load(cls, path)

    def __repr__(self) -> str:
        """A one-line summary without the values."""
        episodes = f"{counted(len(self.seeds), 'run')} of {counted(self.settings.episodes, 'episode')}"
        return f"<ValueEstimates of {self.env}: {self.settings.method}, {self._size(' x ')}, {episodes}>"

    def _repr_html_(self) -> str:
        """A table and, if there are states, the mean values, for notebooks."""
        options = {name: value for name, value in asdict(self.settings).items() if value is not None}
        facts: dict[str, object] = {
            **options,
            "states": self._size(" × "),
            "weights": f"{self.weights.shape[2]:,}, {self.n_active} active",
            "seeds": f"{len(self.seeds):,}",
            "time": f"{self.seconds:.3g} s",
        }
        values = (html.state_values("Mean values", self.mean),) if self.of_cells else ()
        return html.summary(f"Estimated values in {self.env}", facts, *values)

    def _size(self, times: str) -> str:
        if not self.of_cells:
            count = f"{self.weights.shape[2]:,} features"
            return count if self.is_weighted else f"{self.n_active} of {count}"
        return f"{times.join(map(str, self.shape))} states"


def _summed(weights: NDArray[np.float64], active: NDArray[Any]) -> NDArray[np.float64]:
    """Returns (seeds, ...): the sums of (n_active, ...) weights, added from left to right as in the methods."""
    return summed(weights[:, rows] for rows in active)


def _of_shape(name: str, numbers: ArrayLike, shape: tuple[int, ...], where: str) -> NDArray[np.float64]:
    array = np.asarray(numbers, dtype=np.float64)
    if array.shape != shape:
        raise ValueError(f"{name} must have the shape {shape} of the {where}, got {array.shape}")
    return array
