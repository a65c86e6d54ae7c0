"""The positions of states in a picture: along the axes of the observation, on a map, or as in the book."""

from qtab.plots.arrangements.arrange import arrange
from qtab.plots.arrangements.raster import Raster

__all__ = ["Raster", "arrange"]
