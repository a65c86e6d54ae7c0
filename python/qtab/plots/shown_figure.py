"""A figure of pyplot's that a notebook shows once."""

import matplotlib
from matplotlib import pyplot as plt
from matplotlib.figure import Figure


class ShownFigure(Figure):
    """A figure that a notebook shows at the end of the cell, or as the cell's result, but not twice."""

    def _ipython_display_(self) -> None:
        """Called before IPython shows the figure, which it then does as usual.

        Raises:
            NotImplementedError: always, by which IPython knows that it must show the figure itself.
        """
        if "inline" in matplotlib.get_backend().lower():
            plt.close(self)  # or else it would be shown again at the end of the cell
        raise NotImplementedError
