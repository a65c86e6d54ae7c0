"""Prepares a run: finds its environment, fills in all settings, and computes the memory."""
