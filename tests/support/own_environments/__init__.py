"""Environments as users write them, with ``qtab.FunctionalEnv``."""
