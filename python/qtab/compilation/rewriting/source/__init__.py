"""The source code of functions, and what its syntax tells before it is rewritten."""
