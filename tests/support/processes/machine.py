"""The machine that the tests run on.

CartPole, Acrobot and Pendulum call NumPy's sine and cosine. Where those are not the platform's, qtab steps them in
Gymnasium's own code, so equality holds on every machine; ``MACHINE`` tells on which one a test failed.
"""

import warnings

from numpy._core import _multiarray_umath  # type: ignore[attr-defined]

from qtab import _core
from qtab._utils.versions import versions

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # one warning at the first call, where they differ
    _core.numpy_uses_libm()
MACHINE = {
    **versions(),
    "NumPy calls the platform": _core.numpy_uses_libm(),
    "CPU": [name for name, present in _multiarray_umath.__cpu_features__.items() if present],
}
