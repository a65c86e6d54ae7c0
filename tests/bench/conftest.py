"""The loops for Numba run as functions of Python here, which takes less time than to compile them."""

import os

os.environ["NUMBA_DISABLE_JIT"] = "1"  # read when Numba is imported
