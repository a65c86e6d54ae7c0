"""Prediction: the values of a given policy, estimated from episodes."""
