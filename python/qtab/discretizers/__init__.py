"""From an observation to the active rows of the table: one discretizer a file."""
