"""Environments stepped in Python: compiled code is compared with them, and a step that fails in it is repeated."""
