"""Helpers that every folder uses: argument checks, files, extras, versions, progress, memory."""
