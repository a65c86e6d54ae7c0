"""A pyplot figure that a notebook shows once."""

import matplotlib
from matplotlib import pyplot as plt
from matplotlib.figure import Figure


class ShownFigure(Figure):
    """A figure that a notebook shows at the end of the cell, or as the cell's result, but not twice."""

    def _ipython_display_(self) -> None:
        """Called before IPython shows the figure, which it then does as usual.

        Raises:
            NotImplementedError: always, so that IPython shows the figure itself.
        """
        if "inline" in matplotlib.get_backend().lower():
            plt.close(self)  # an open figure would be shown again at the end of the cell
        raise NotImplementedError  # IPython's protocol: it then uses its other ways to show an object
