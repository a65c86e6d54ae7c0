"""Replays of recorded episodes, in a window or as videos."""
