"""Environments that Rust steps through the C interface ``qtab_env.h``: shared libraries, and compiled functions."""
