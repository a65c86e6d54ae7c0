"""The learners in plain NumPy, on Gymnasium's own environments: slow, readable, and what the fast ones must equal."""

from qtab.reference.q_learning import q_learning
from qtab.reference.streams import agent_stream

__all__ = ["agent_stream", "q_learning"]
