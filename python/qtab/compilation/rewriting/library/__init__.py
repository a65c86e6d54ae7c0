"""The functions and methods of Python, ``math`` and NumPy that compiled code computes to the same bits."""
