"""Helpers for the whole package: argument checks, files, optional libraries, versions, progress bars, memory."""
