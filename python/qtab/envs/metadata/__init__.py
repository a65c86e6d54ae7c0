"""What is known of an environment beside its steps: the best returns, and the names and units of its quantities."""
