"""Training step by step: what an agent did, why, and how each update was computed."""
