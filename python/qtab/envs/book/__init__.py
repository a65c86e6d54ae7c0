"""Environments of Sutton & Barto's book that Gymnasium does not have; its grid worlds are in ``grid_worlds``."""
