"""Whether a notebook shows what a call displays."""

import sys


def in_notebook() -> bool:
    """Returns whether this code runs in the kernel of a notebook, which can show pictures and widgets."""
    ipython = sys.modules.get("IPython")  # a kernel has imported it
    shell = None if ipython is None else ipython.get_ipython()
    return getattr(shell, "kernel", None) is not None
