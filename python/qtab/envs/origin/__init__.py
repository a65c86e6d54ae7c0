"""The origin of a run: the description of its environment, its comparison with others, and its re-creation."""
