"""The three C functions around the functions of an environment, and what they need in code compiled by Numba."""
