"""Info dicts: what they hold, the action mask in them, and what else a vector environment shows."""
