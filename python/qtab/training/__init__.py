"""Training, evaluation and verification of agents."""
