"""The learners in plain NumPy, on Gymnasium's own environments: slow, readable, and equal to Rust to the last bit."""

from collections.abc import Callable, Mapping

from qtab.reference.actor_critic import actor_critic, actor_critic_lambda
from qtab.reference.double_q_learning import double_q_learning
from qtab.reference.dyna_q import dyna_q
from qtab.reference.dyna_q_plus import dyna_q_plus
from qtab.reference.expected_sarsa import expected_sarsa
from qtab.reference.gradient_bandit import gradient_bandit
from qtab.reference.n_step_sarsa import n_step_sarsa
from qtab.reference.q_learning import q_learning
from qtab.reference.reinforce import reinforce, reinforce_with_baseline
from qtab.reference.sarsa import sarsa
from qtab.reference.sarsa_lambda import sarsa_lambda
from qtab.reference.streams import agent_stream
from qtab.reference.task import Result
from qtab.reference.true_online_sarsa_lambda import true_online_sarsa_lambda
from qtab.reference.watkins_q_lambda import watkins_q_lambda

LEARNERS: Mapping[str, Callable[..., Result]] = {
    learner.__name__: learner
    for learner in (
        q_learning,
        sarsa,
        expected_sarsa,
        double_q_learning,
        n_step_sarsa,
        sarsa_lambda,
        true_online_sarsa_lambda,
        watkins_q_lambda,
        dyna_q,
        dyna_q_plus,
        gradient_bandit,
        reinforce,
        reinforce_with_baseline,
        actor_critic,
        actor_critic_lambda,
    )
}
"""Each algorithm by its name."""

__all__ = [
    "LEARNERS",
    "actor_critic",
    "actor_critic_lambda",
    "agent_stream",
    "double_q_learning",
    "dyna_q",
    "dyna_q_plus",
    "expected_sarsa",
    "gradient_bandit",
    "n_step_sarsa",
    "q_learning",
    "reinforce",
    "reinforce_with_baseline",
    "sarsa",
    "sarsa_lambda",
    "true_online_sarsa_lambda",
    "watkins_q_lambda",
]
