"""Compilation of environments written in Python with Numba, to the C functions of ``qtab_env.h``.

The road from a class to its C functions; ``functional`` and ``ordinary`` take it for the two kinds of environments:

1. ``twins`` searches an ordinary Gymnasium class for effects outside of it, before a copy of it is run.
2. ``rewriting`` turns the class into plain functions over a record of its attributes. The methods of a
   ``FunctionalEnv`` are such functions already; ``called_functions`` finds those that they call.
3. ``layouts`` say where the numbers of states, observations and parameters lie in memory.
4. ``c_functions`` wraps the functions in ``qtab_reset``, ``qtab_step`` and ``qtab_observe``, and Numba compiles them.
   ``checks`` refuse what would round differently, and raise errors where Python does.
5. ``cache`` turns the result into machine code, and stores it beside the user's file under a digest of everything that
   it depends on. Later processes load it without Numba.
6. ``proof`` plays episodes in Python and in compiled code, and compares every number.
7. ``interface`` puts the addresses into a ``qtab_env`` struct in a capsule, which Rust takes. Where a call of an
   ordinary class fails, ``twins`` repeats it in Python.

What cannot be compiled raises ``NotCompilable``. Numba is imported only when something is compiled.
"""

from qtab.compilation.not_compilable import NotCompilable

__all__ = ["NotCompilable"]
