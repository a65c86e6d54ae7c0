"""The files of runs: their format, writing, loading and checking, and policies as plain JSON."""
