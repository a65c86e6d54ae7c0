"""Ordinary Gymnasium classes as functions over a record of numbers, for compilation.

``rewrite`` reads the source code of a class, follows ``reset`` and ``step`` through the user's methods and functions,
and evaluates what is constant: branches that cannot be taken disappear, and constants become numbers. The rest must
consist of what compiled code computes to the same bits as Python and NumPy; anything else raises ``NotCompilable``.
"""

from qtab.compilation.rewriting.rewrite import Rewritten, rewrite

__all__ = ["Rewritten", "rewrite"]
