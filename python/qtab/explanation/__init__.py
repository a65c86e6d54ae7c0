"""Training step by step: each choice of an action with its reason, and each update with its numbers."""
