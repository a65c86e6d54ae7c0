"""The frames of a video, compressed: an episode of 200 frames takes about a megabyte instead of 144."""

import zlib
from collections.abc import Iterator
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab._utils.shown import shown


class Frames:
    """Pictures of one size, in the order in which they are shown.

    Args:
        fps: The number of pictures per second.
    """

    def __init__(self, fps: float) -> None:
        self.fps = fps
        self.labels: list[str] = []
        """The label of each picture."""
        self._shape: tuple[int, ...] | None = None
        self._compressed: list[bytes] = []

    def __len__(self) -> int:
        return len(self._compressed)

    def __iter__(self) -> Iterator[NDArray[np.uint8]]:
        """Yields (height, width, 3) pictures."""
        for compressed in self._compressed:
            yield np.frombuffer(zlib.decompress(compressed), np.uint8).reshape(self._shape or ())

    @property
    def size(self) -> tuple[int, int]:
        """The width and the height in pixels."""
        height, width, _ = self._shape or (0, 0, 0)
        return width, height

    def append(self, picture: Any, label: str) -> None:
        """Adds a picture, as ``env.render()`` returns it in the render mode ``rgb_array``.

        Raises:
            TypeError: if it is not a (height, width, 3) array of uint8.
            ValueError: if it has another size than the first picture.
        """
        if not isinstance(picture, np.ndarray) or picture.dtype != np.uint8 or picture.ndim != 3:
            raise TypeError(f"env.render() must return a (height, width, 3) array of uint8, got {shown(picture)}")
        if picture.shape[2] != 3 or picture.shape != (self._shape or picture.shape):
            expected = "(height, width, 3)" if self._shape is None else self._shape
            raise ValueError(f"env.render() must return arrays of shape {expected}, got {picture.shape}")
        self._shape = picture.shape
        compressed = zlib.compress(picture.tobytes(), 1)
        if self._compressed and self._compressed[-1] == compressed:
            compressed = self._compressed[-1]  # an unchanged picture takes no memory
        self._compressed.append(compressed)
        self.labels.append(label)


def frames_per_second(env: gym.Env, given: float | None) -> float:
    """Returns the given speed, or that of the environment."""
    rate: Any = env.unwrapped.metadata.get("render_fps") if given is None else given
    return float(rate or 30)
