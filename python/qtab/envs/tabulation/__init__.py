"""Transition tables of environments with few states: :func:`qtab.tabulate`."""
