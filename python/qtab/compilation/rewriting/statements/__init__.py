"""Statements: each becomes lines of the program, or nothing."""
