"""Where a picture shows which state: along the axes of the observation, on a map, or as a book draws it."""

from qtab.plots.arrangements.arrange import arrange
from qtab.plots.arrangements.raster import Raster

__all__ = ["Raster", "arrange"]
