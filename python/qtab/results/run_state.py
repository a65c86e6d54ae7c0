"""The state that a run holds beside its tables and episodes, so that it can be resumed exactly where it stopped."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, repr=False)
class RunState:
    """The random generators, the unfinished episode, and the learner's state: traces, visits, models."""

    checkpoint: bytes
    """The extension's serialized state."""
    generator: Mapping[str, Any] | None
    """The state of the bit generator of an environment that is stepped in Python, as JSON data."""
    snapshots: tuple[int, ...] = ()
    """The numbers of episodes at which snapshots are still to be taken, ascending."""
    extensions: tuple[tuple[int, int], ...] = ()
    """(finished, episodes) for each extension of the run with a falling rate: the number of episodes finished at the
    time, and the number over which the rate had been spread until then."""

    def __repr__(self) -> str:
        return f"<RunState of {len(self.checkpoint):,} bytes>"

    def array(self) -> NDArray[np.uint8]:
        """Returns the checkpoint as an array for a file."""
        return np.frombuffer(self.checkpoint, np.uint8)

    def header(self) -> dict[str, Any]:
        """Returns the rest of the state for the header of a file."""
        optional = {"snapshots": self.snapshots, "extensions": self.extensions}
        return {"generator": self.generator, **{name: value for name, value in optional.items() if value}}

    @classmethod
    def restore(cls, array: NDArray[Any], generator: Any, snapshots: Any, extensions: Any) -> "RunState":
        """Returns the state from the unchecked content of a file.

        Raises:
            ValueError: if the content is not a state.
        """
        if array.dtype != np.uint8 or array.ndim != 1:
            raise ValueError(f"its state has dtype {array.dtype} and {array.ndim} axes, not uint8 and 1")
        if not (generator is None or isinstance(generator, dict)):
            raise ValueError(f"its generator must be a JSON object or null, got {generator!r}")
        if not isinstance(snapshots, list) or not all(type(number) is int and number >= 0 for number in snapshots):
            raise ValueError(f"its snapshots to be taken must be a list of episodes, got {snapshots!r}")
        if any(number >= following for number, following in pairwise(snapshots)):
            raise ValueError("its snapshots to be taken are not at ascending episodes")
        if not isinstance(extensions, list) or not all(map(_is_extension, extensions)):
            raise ValueError(f"its extensions must be a list of pairs of numbers of episodes, got {extensions!r}")
        return cls(array.tobytes(), generator, tuple(snapshots), tuple((first, total) for first, total in extensions))


def _is_extension(pair: Any) -> bool:
    return isinstance(pair, list) and [type(number) for number in pair] == [int, int] and 1 <= pair[0] <= pair[1]


def generator_state(generator: np.random.Generator) -> dict[str, Any]:
    """Returns the state of a bit generator in the types of JSON."""
    state: dict[str, Any] = _to_json(generator.bit_generator.state)
    return state


def restored_generator(state: Mapping[str, Any]) -> np.random.Generator:
    """Returns a generator whose bit generator, a PCG64, is in a recorded state."""
    bit_generator = np.random.PCG64()
    bit_generator.state = dict(state)  # type: ignore[assignment]
    return np.random.Generator(bit_generator)


def _to_json(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {str(name): _to_json(item) for name, item in value.items()}
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else value
