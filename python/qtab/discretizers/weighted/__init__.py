"""Discretizers with weighted features: each row of the table has a number for an observation."""
