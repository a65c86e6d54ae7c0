"""Copies of ordinary Gymnasium environments that are stepped in Python, to prove compiled code or where it fails."""
