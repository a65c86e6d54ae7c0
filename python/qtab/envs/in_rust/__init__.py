"""Gymnasium's environments in Rust: which environment objects it replaces, and the constants or tables it reads."""
