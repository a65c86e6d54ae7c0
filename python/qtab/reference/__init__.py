"""The learners in plain NumPy, on Gymnasium's own environments: slow, readable, and equal to Rust to the last bit."""

from collections.abc import Callable, Mapping

from qtab.config.choices import CHOICES
from qtab.reference.actor_critic import actor_critic as actor_critic
from qtab.reference.actor_critic import actor_critic_lambda as actor_critic_lambda
from qtab.reference.average_reward import differential_q_learning as differential_q_learning
from qtab.reference.average_reward import differential_sarsa as differential_sarsa
from qtab.reference.double_q_learning import double_q_learning as double_q_learning
from qtab.reference.dyna_q import dyna_q as dyna_q
from qtab.reference.dyna_q import dyna_q_plus as dyna_q_plus
from qtab.reference.monte_carlo import monte_carlo as monte_carlo
from qtab.reference.monte_carlo import monte_carlo_es as monte_carlo_es
from qtab.reference.monte_carlo import off_policy_monte_carlo as off_policy_monte_carlo
from qtab.reference.n_step import n_step_q_sigma as n_step_q_sigma
from qtab.reference.n_step import n_step_sarsa as n_step_sarsa
from qtab.reference.n_step import n_step_tree_backup as n_step_tree_backup
from qtab.reference.parts.streams import agent_stream as agent_stream
from qtab.reference.parts.task import Result
from qtab.reference.policy_gradient import gradient_bandit as gradient_bandit
from qtab.reference.policy_gradient import reinforce as reinforce
from qtab.reference.policy_gradient import reinforce_with_baseline as reinforce_with_baseline
from qtab.reference.prioritized_sweeping import prioritized_sweeping as prioritized_sweeping
from qtab.reference.q_learning import q_learning as q_learning
from qtab.reference.sarsa import expected_sarsa as expected_sarsa
from qtab.reference.sarsa import sarsa as sarsa
from qtab.reference.sarsa_lambda import sarsa_lambda as sarsa_lambda
from qtab.reference.true_online_sarsa_lambda import true_online_sarsa_lambda as true_online_sarsa_lambda
from qtab.reference.watkins_q_lambda import watkins_q_lambda as watkins_q_lambda

LEARNERS: Mapping[str, Callable[..., Result]] = {name: globals()[name] for name in CHOICES["algorithm"]}
"""Each algorithm by its name."""
