"""Detects notebooks, and makes progress bars that leave no output in a notebook once they are closed."""

import sys
import warnings
from typing import Any


def in_notebook() -> bool:
    """Returns whether this code runs in a notebook kernel, which can show pictures and widgets."""
    ipython = sys.modules.get("IPython")  # a kernel has imported it
    shell = None if ipython is None else ipython.get_ipython()
    return getattr(shell, "kernel", None) is not None


def notebook_bar(**options: Any) -> Any:
    """Returns a tqdm bar as a widget, or as text if ipywidgets is not installed.

    Args:
        **options: As for ``tqdm.tqdm``.

    Raises:
        ModuleNotFoundError: without tqdm.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # tqdm warns without ipywidgets, but a text bar is enough
        from tqdm import notebook, tqdm
    if notebook.IProgress is None:
        return tqdm(**options)

    class WidgetProgressBar(notebook.tqdm_notebook):  # type: ignore[misc] # tqdm has no types
        """tqdm's widget, whose output can be replaced.

        tqdm closes the widget, but its output stays: a saved notebook would show the bar as it was first drawn, or an
        error where the widget was.
        """

        output: Any = None

        def display(self, *arguments: Any, check_delay: bool = True, **keywords: Any) -> None:
            """Draws the bar, and shows it once its delay is over."""
            from IPython import display

            super().display(*arguments, check_delay=False, **keywords)
            if check_delay and self.output is None:
                show: Any = display.display
                self.output = show(self.container, display_id=True)

        def close(self) -> None:
            """Closes the bar, and empties its output."""
            super().close()
            if self.output is not None:
                self.output.update({"text/plain": ""}, raw=True)
                self.output = None

    bar = WidgetProgressBar(display=False, **options)
    if options.get("delay", 0.0) <= 0.0:
        bar.display()
    return bar
