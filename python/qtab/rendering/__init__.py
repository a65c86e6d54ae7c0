"""Recorded episodes replayed: in a window, or as videos."""
