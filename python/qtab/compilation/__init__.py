"""Compilation of environments written in Python with Numba, to the C functions of ``qtab_env.h``.

Numba is imported only when something is compiled; compiled code is stored, and loaded without it.
"""

from qtab.compilation.not_compilable import NotCompilable

__all__ = ["NotCompilable"]
