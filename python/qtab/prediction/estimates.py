"""``qtab.ValueEstimates``: the estimated values of a policy, for each seed, and how they developed."""

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from qtab._utils import checks, html, svg
from qtab._utils.fields import with_fields
from qtab._utils.files import replacing
from qtab.config import Config
from qtab.prediction.learning_rates import OPTIONS
from qtab.prediction.settings import PredictionSettings

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from qtab.prediction.verification import ValuesVerification

_ARRAYS = ("episodes", "weights", "rows", "probabilities", "behavior")
FORMAT = 1


@with_fields
@dataclass(frozen=True, eq=False, repr=False)
class ValueEstimates:
    """The values of a policy as one method estimated them, with one run for each seed."""

    env: str
    """The environment's id, or the name of its class."""
    settings: PredictionSettings
    """The method and its options."""
    seeds: tuple[int, ...]
    """(seeds,): the seed of each run."""
    episodes: NDArray[np.int64]
    """(points,): after how many episodes the weights were recorded, ascending; the last one is the last episode."""
    weights: NDArray[np.float64]
    """(seeds, points, n_weights): the recorded weights: of a table the values themselves."""
    rows: NDArray[np.uint32]
    """(states, n_active): the active features of each state, whose weights add up to its value."""
    probabilities: NDArray[np.float64]
    """(*cells, actions): the policy that is evaluated."""
    behavior: NDArray[np.float64]
    """(*cells, actions): the policy that chose the actions: the same, except off policy."""
    config: Config | None = field(repr=False, default=None)
    """The task as a config, by which it can be verified; None for estimates from a file."""
    seconds: float = 0.0
    """The wall-clock time of the computation."""

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the values of a run: the number of cells along each component of the observation."""
        return self.probabilities.shape[:-1]

    @property
    def values(self) -> NDArray[np.float64]:
        """(seeds, *cells): the values after the last episode."""
        return self.values_after(-1)

    @property
    def mean(self) -> NDArray[np.float64]:
        """(*cells,): the mean of the final values over the seeds."""
        mean: NDArray[np.float64] = self.values.mean(axis=0)
        return mean

    @property
    def standard_error(self) -> NDArray[np.float64]:
        """(*cells,): the standard error of :attr:`mean`; NaN for a single seed."""
        if len(self.seeds) == 1:
            return np.full(self.shape, np.nan)
        error: NDArray[np.float64] = self.values.std(axis=0, ddof=1) / np.sqrt(len(self.seeds))
        return error

    def values_after(self, point: int) -> NDArray[np.float64]:
        """Returns (seeds, *cells): the values at one of the recorded points, by its index."""
        weights = self.weights[:, point]
        # From left to right, as the methods sum them.
        total = weights[:, self.rows[:, 0]]
        for active in self.rows.T[1:]:
            total = total + weights[:, active]
        return total.reshape(len(self.seeds), *self.shape)

    def rms_error(self, true_values: ArrayLike, weights: ArrayLike | None = None) -> NDArray[np.float64]:
        """Returns (seeds, points): the root of the weighted mean of the squared errors over the states.

        Args:
            true_values: (*cells,): the true values, such as those of :func:`qtab.policy_values`.
            weights: (*cells,): how much each state counts, such as ``state_distribution`` for the value error VE of
                Sutton & Barto's equation 9.1; None counts all the same.

        Raises:
            ValueError: if an argument has another shape, or the weights are negative or all zero.
        """
        exact = self._per_state("true_values", true_values)
        shares = np.ones(exact.shape) if weights is None else self._per_state("weights", weights)
        if not (shares >= 0.0).all() or not shares.sum() > 0.0:
            raise ValueError("weights must be at least 0 and not all 0")
        shares = shares / shares.sum()
        axes = tuple(range(1, exact.ndim + 1))
        with np.errstate(over="ignore"):  # values that diverge have an infinite error
            errors = [
                np.sqrt((shares * (self.values_after(point) - exact) ** 2).sum(axis=axes))
                for point in range(len(self.episodes))
            ]
        return np.stack(errors, axis=1)

    def _per_state(self, name: str, numbers: ArrayLike) -> NDArray[np.float64]:
        array = np.asarray(numbers, dtype=np.float64)
        if array.shape != self.shape:
            raise ValueError(f"{name} must have the shape {self.shape} of the states, got {array.shape}")
        return array

    def verify(self, episodes: int | None = None, seed: int | None = None) -> "ValuesVerification":
        """Estimates again in plain NumPy in Gymnasium's environment, and compares the weights byte for byte.

        Args:
            episodes: How many episodes: one of :attr:`episodes`; None means all.
            seed: One of :attr:`seeds`; None means the first.

        Raises:
            ValueError: for a number that was not recorded, another seed, or an environment without an id.
        """
        from qtab.prediction.verification import verify_values

        return verify_values(self, episodes, seed)

    def plot(self, ax: "Axes | None" = None, *, true_values: ArrayLike | None = None) -> "Axes":
        """Draws the mean values over the states, and returns the axes.

        States of one component are a line with a band of two standard errors to each side; those of two or more are a
        map of the first two components, with the others at the middle of their range.

        Args:
            ax: The axes to draw on; None creates a new figure.
            true_values: (*cells,): the true values, drawn as a dashed line beside those of one component.

        Raises:
            ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        """
        from qtab.prediction.plot import draw_values

        return draw_values(self, ax, None if true_values is None else self._per_state("true_values", true_values))

    def save(self, path: Path | str) -> None:
        """Writes the estimates to an ``.npz`` file, completely or not at all.

        Raises:
            OSError: if the file cannot be written.
        """
        # Schedules only where there are any, so that earlier versions can read the others.
        settings = {
            name: value
            for name, value in asdict(self.settings).items()
            if value is not None or name not in ("learning_rate_schedule", *OPTIONS)
        }
        about = {"format": FORMAT, "env": self.env, "settings": settings, "seeds": list(self.seeds)}
        text = np.array(json.dumps({**about, "seconds": self.seconds}))
        with replacing(checks.path("path", path)) as temporary, temporary.open("wb") as file:
            np.savez_compressed(file, about=text, **{name: getattr(self, name) for name in _ARRAYS})

    @classmethod
    def load(cls, path: Path | str) -> "ValueEstimates":
        """Reads estimates that :meth:`save` wrote.

        Raises:
            OSError: if the file is missing or cannot be read.
            ValueError: if it is not such a file.
        """
        with checks.path("path", path).open("rb") as file:
            try:
                with np.load(file, allow_pickle=False) as arrays:
                    about: Any = json.loads(str(arrays["about"]))
                    loaded = {name: arrays[name] for name in _ARRAYS}
                    made = cls(
                        env=str(about["env"]),
                        settings=PredictionSettings(**about["settings"]),
                        seeds=tuple(int(seed) for seed in about["seeds"]),
                        seconds=float(about["seconds"]),
                        **loaded,
                    )
                if about["format"] != FORMAT or made.weights.shape[:2] != (len(made.seeds), len(made.episodes)):
                    raise ValueError("its arrays do not fit each other")
                made.values_after(-1)
            except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
                raise ValueError(f"not a file of value estimates: {path}: {error}") from None
        return made

    def __repr__(self) -> str:
        """One line: the values are not shown."""
        runs = "1 run" if len(self.seeds) == 1 else f"{len(self.seeds):,} runs"
        states = " x ".join(map(str, self.shape))
        return (
            f"<ValueEstimates of {self.env}: {self.settings.method}, {states} states, {runs} of "
            f"{self.settings.episodes:,} episodes>"
        )

    def _repr_html_(self) -> str:
        """A table and the mean values, for notebooks."""
        options = {name: value for name, value in asdict(self.settings).items() if value is not None}
        facts: dict[str, object] = {
            **options,
            "states": " × ".join(map(str, self.shape)),
            "weights": f"{self.weights.shape[2]:,}, {self.rows.shape[1]} active",
            "seeds": f"{len(self.seeds):,}",
            "time": f"{self.seconds:.3g} s",
        }
        if len(self.shape) == 2:
            picture = svg.field(f"Mean values, {' rows by '.join(map(str, self.shape))} columns", self.mean)
        else:
            picture = svg.lines("The mean value of each state, by its number", {"value": self.mean.ravel()})
        return html.summary(f"Estimated values in {self.env}", facts, picture)
