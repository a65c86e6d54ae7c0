"""The source code of functions, and what its syntax shows before it is rewritten."""
