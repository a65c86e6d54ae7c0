"""Exercises for a class: a file to hand out, and the marks of a folder of submissions."""
