"""Expressions: each becomes a constant, or code with a kind."""
