"""The twelve exercises, one per file: the starter code, the model with its mistakes, and the checks."""
