"""The learners in plain NumPy, on Gymnasium's own environments: slow, readable, and equal to Rust to the last bit."""

from collections.abc import Callable, Mapping

from qtab.config.choices import CHOICES
from qtab.reference.actor_critic import actor_critic, actor_critic_lambda
from qtab.reference.average_reward import differential_q_learning, differential_sarsa
from qtab.reference.double_q_learning import double_q_learning
from qtab.reference.dyna_q import dyna_q, dyna_q_plus
from qtab.reference.monte_carlo import monte_carlo, monte_carlo_es, off_policy_monte_carlo
from qtab.reference.n_step import n_step_q_sigma, n_step_sarsa, n_step_tree_backup
from qtab.reference.parts.streams import agent_stream
from qtab.reference.parts.task import Result
from qtab.reference.policy_gradient import gradient_bandit, reinforce, reinforce_with_baseline
from qtab.reference.prioritized_sweeping import prioritized_sweeping
from qtab.reference.q_learning import q_learning
from qtab.reference.sarsa import expected_sarsa, sarsa
from qtab.reference.sarsa_lambda import sarsa_lambda
from qtab.reference.true_online_sarsa_lambda import true_online_sarsa_lambda
from qtab.reference.watkins_q_lambda import watkins_q_lambda

__all__ = [
    "LEARNERS",
    "actor_critic",
    "actor_critic_lambda",
    "agent_stream",
    "differential_q_learning",
    "differential_sarsa",
    "double_q_learning",
    "dyna_q",
    "dyna_q_plus",
    "expected_sarsa",
    "gradient_bandit",
    "monte_carlo",
    "monte_carlo_es",
    "n_step_q_sigma",
    "n_step_sarsa",
    "n_step_tree_backup",
    "off_policy_monte_carlo",
    "prioritized_sweeping",
    "q_learning",
    "reinforce",
    "reinforce_with_baseline",
    "sarsa",
    "sarsa_lambda",
    "true_online_sarsa_lambda",
    "watkins_q_lambda",
]

LEARNERS: Mapping[str, Callable[..., Result]] = {name: globals()[name] for name in CHOICES["algorithm"]}
"""Each algorithm by its name."""
