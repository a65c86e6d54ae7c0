"""Writing value estimates to a file, and reading them again."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab import discretizers
from qtab._utils import checks
from qtab._utils.files import replacing
from qtab.config import Config, options
from qtab.discretizers import Discretizer
from qtab.discretizers.box import BoxDiscretizer
from qtab.prediction.learning_rates import OPTIONS
from qtab.prediction.settings import PredictionSettings

if TYPE_CHECKING:
    from qtab.prediction.estimates import ValueEstimates

_ARRAYS = ("episodes", "weights")
_VECTORS = "feature_vectors"
_OF_STATES = ("rows", "probabilities", "behavior")
"""The arrays present if the policy and the features are those of numbered states or of cells."""
FORMAT = 1
OBSERVATIONS_FORMAT = 2
"""The format of estimates without some of these arrays, which earlier versions could not read."""
WEIGHTED_FORMAT = 3
"""The format of estimates with weighted features, which earlier versions could not read."""
DISCRETIZER = ("discretizer", "scale", "bins", "edges", "low", "high", "tiles", "tilings", "hashed_rows")
"""The settings of a run from which the discretizer of a Box is restored."""
OF_WEIGHTED = tuple(name for name, option in options.OPTIONS.items() if set(option.values) <= set(options.WEIGHTED))
"""Those that only weighted features have."""
ADDED = ("learning_rate_schedule", *OPTIONS, "second_learning_rate", "epsilon", "recursive")
"""The settings of an estimate that are written only if they are set, so that earlier versions can read other files."""


def save(estimates: "ValueEstimates", path: Path | str) -> None:
    """Writes estimates to a file; see :meth:`qtab.ValueEstimates.save`."""
    settings = {
        name: value for name, value in asdict(estimates.settings).items() if value is not None or name not in ADDED
    }
    arrays = {name: getattr(estimates, name) for name in _ARRAYS}
    given = {name: getattr(estimates, name) for name in _OF_STATES}
    arrays |= {name: array for name, array in given.items() if array is not None}
    is_complete = all(array is not None for array in given.values())
    if estimates.feature_vectors is not None:
        arrays[_VECTORS] = estimates.feature_vectors
    about: dict[str, Any] = {
        "format": WEIGHTED_FORMAT if estimates.is_weighted else FORMAT if is_complete else OBSERVATIONS_FORMAT,
        "env": estimates.env,
        "settings": settings,
        "seeds": list(estimates.seeds),
    }
    cells, config = estimates.discretizer, estimates.config
    if isinstance(cells, BoxDiscretizer) and config is not None:
        names = (*DISCRETIZER, *OF_WEIGHTED) if cells.is_weighted else DISCRETIZER
        about["discretizer"] = {name: getattr(config, name) for name in names}
        arrays |= {f"discretizer_{name}": array for name, array in cells.arrays().items()}
    text = np.array(json.dumps({**about, "seconds": estimates.seconds}))
    with replacing(checks.file_path("path", path)) as temporary, temporary.open("wb") as file:
        np.savez_compressed(file, about=text, **arrays)


def load(cls: type["ValueEstimates"], path: Path | str) -> "ValueEstimates":
    """Reads estimates from a file; see :meth:`qtab.ValueEstimates.load`."""
    with checks.file_path("path", path).open("rb") as file:
        try:
            with np.load(file, allow_pickle=False) as arrays:
                about: Any = json.loads(str(arrays["about"]))
                if about["format"] not in (FORMAT, OBSERVATIONS_FORMAT, WEIGHTED_FORMAT):
                    raise ValueError(f"its format {about['format']} is unknown")
                optional = about["format"] != FORMAT
                loaded = {name: arrays[name] for name in _ARRAYS}
                loaded |= {name: arrays[name] for name in _OF_STATES if not optional or name in arrays}
                loaded |= {name: arrays[name] for name in (_VECTORS,) if name in arrays}
                weights = loaded["weights"]
                made = cls(
                    env=str(about["env"]),
                    settings=PredictionSettings(**about["settings"]),
                    seeds=tuple(int(seed) for seed in about["seeds"]),
                    seconds=float(about["seconds"]),
                    discretizer=_discretizer(about, arrays, weights.shape[2]),
                    **{**dict.fromkeys(_OF_STATES), **loaded},
                )
            if weights.shape[:2] != (len(made.seeds), len(made.episodes)):
                raise ValueError("its arrays do not fit each other")
            vectors = made.feature_vectors
            if vectors is not None and (vectors.dtype, vectors.shape[1:]) != (weights.dtype, weights.shape[2:]):
                raise ValueError("its weights do not fit its features")
            if made.of_cells:
                made.values_after(-1)
            elif made.discretizer is None or made.discretizer.n_rows != weights.shape[2]:
                raise ValueError("its weights do not fit its discretizer")
        except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
            raise ValueError(f"not a file of value estimates: {path}: {error}") from None
    return made


def _discretizer(about: Any, arrays: Any, n_weights: int) -> Discretizer | None:
    if "discretizer" not in about:
        return None
    # The scale and the edges are lists in the file, which the config converts to tuples.
    names = [*DISCRETIZER, *(name for name in OF_WEIGHTED if name in about["discretizer"])]
    config = Config(env=str(about["env"]), **{name: about["discretizer"][name] for name in names})
    stored = {name.removeprefix("discretizer_"): arrays[name] for name in arrays if name.startswith("discretizer_")}
    return discretizers.restore(config, stored, n_weights)
