"""Off-policy methods for linear values, one transition at a time, in plain NumPy (Sutton & Barto, 2nd ed., chapter 11).

Each object has the weights ``w`` of one run and changes them in place. Feature vectors are (d,) float64; that of a
terminal state is zero.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab.prediction.observation_policies import TablePolicy
from qtab.prediction.reference.policies import policy_of, probability, sampled

Vector = NDArray[np.float64]


def dot(a: Vector, b: Vector) -> float:
    """Returns Σ a b: every fourth product added from left to right, and the four sums in pairs, unlike ``np.dot``."""
    parts = [0.0] * 4
    for index, (one, other) in enumerate(zip(a.tolist(), b.tolist(), strict=True)):
        parts[index % 4] += one * other
    return (parts[0] + parts[1]) + (parts[2] + parts[3])


class OffPolicyUpdate(ABC):
    """The weights of a run and how a transition changes them.

    Args:
        w: (d,): the initial weights, which are changed.
        alpha: α, the step size of the weights, or (d,) of each one.
        gamma: γ, the discount.
        beta: β, the step size of the second weight vector, for the methods that have one, or (d,) of each weight.
    """

    def __init__(self, w: Vector, alpha: float | Vector, gamma: float, beta: float | Vector = 0.0) -> None:
        self.w, self.alpha, self.gamma, self.beta = w, alpha, gamma, beta
        self.v = np.zeros_like(w)

    def start_episode(self) -> None:  # noqa: B027 - most methods have nothing to do
        """Begins an episode: forgets what the previous one left, apart from the weights."""

    def error(self, x: Vector, reward: float, next_x: Vector) -> float:
        """Returns δ = R + γ wᵀx' - wᵀx."""
        return reward + self.gamma * dot(self.w, next_x) - dot(self.w, x)

    def update(self, x: Vector, reward: float, next_x: Vector, rho: float) -> None:
        """Changes the weights by a transition from a state to the next one.

        Args:
            x: The features of the state.
            reward: R.
            next_x: The features of the next state.
            rho: ρ = π(A|S) / b(A|S), the importance sampling ratio of the action.
        """
        self.move(x, next_x, rho, self.error(x, reward, next_x), dot(self.v, x))

    @abstractmethod
    def move(self, x: Vector, next_x: Vector, rho: float, error: float, correction: float) -> None:
        """Changes the weights, given the TD error δ and the correction vᵀx."""


class SemiGradientTD(OffPolicyUpdate):
    """Off-policy semi-gradient TD(0) (equation 11.2)."""

    def move(self, x: Vector, next_x: Vector, rho: float, error: float, correction: float) -> None:  # noqa: ARG002
        """W <- w + α ρ δ x."""
        self.w += self.alpha * rho * error * x


class GTD2(OffPolicyUpdate):
    """GTD2 (section 11.7)."""

    def move(self, x: Vector, next_x: Vector, rho: float, error: float, correction: float) -> None:
        """W <- w + α ρ (x - γ x') xᵀv, v <- v + β ρ (δ - vᵀx) x, both with the old w and v."""
        self.w += self.alpha * rho * (x - self.gamma * next_x) * correction
        self.v += self.beta * rho * (error - correction) * x


class TDC(OffPolicyUpdate):
    """TD(0) with gradient correction, also known as GTD(0) (section 11.7)."""

    def move(self, x: Vector, next_x: Vector, rho: float, error: float, correction: float) -> None:
        """W <- w + α ρ (δ x - γ x' xᵀv), v <- v + β ρ (δ - vᵀx) x, both with the old w and v."""
        self.w += self.alpha * rho * (error * x - self.gamma * next_x * correction)
        self.v += self.beta * rho * (error - correction) * x


class EmphaticTD(OffPolicyUpdate):
    """One-step emphatic TD with an interest of 1 in every state (section 11.8)."""

    emphasis = 0.0
    last_rho = 0.0

    def start_episode(self) -> None:
        """Begins an episode with an emphasis of 1 in its first state."""
        self.emphasis = self.last_rho = 0.0

    def move(self, x: Vector, next_x: Vector, rho: float, error: float, correction: float) -> None:  # noqa: ARG002
        """M <- γ ρ M + I with the ρ of the previous step, then w <- w + α M ρ δ x."""
        self.emphasis = self.gamma * self.last_rho * self.emphasis + 1.0
        self.last_rho = rho
        self.w += self.alpha * self.emphasis * rho * error * x


class Transition(NamedTuple):
    """A step of an episode."""

    state: int
    reward: float
    next_state: int
    terminated: bool
    """Whether the next state is terminal, so that its value is zero."""
    over: bool
    """Whether the episode ends here."""
    rho: float
    """The importance sampling ratio of the action."""


def transitions(
    env: gym.Env[Any, Any], target: NDArray[np.float64], behavior: NDArray[np.float64], seed: int
) -> Iterator[Transition]:
    """Yields the steps of one episode after another, without end.

    The random numbers are those of :func:`qtab.estimate_values`: the environment's generator draws the first state of
    an episode and the next states, and the agent's generator one ``random()`` for each action of a behavior that is not
    deterministic, in the order state, action, next state.

    Args:
        env: An environment whose observations are the numbers of its states.
        target: (states, actions): the probabilities of the policy whose values are estimated.
        behavior: (states, actions): the probabilities of the policy that acts.
        seed: The seed of both generators.
    """
    rng = np.random.default_rng(np.random.SeedSequence(seed).spawn(1)[0])
    follows, acts = policy_of(TablePolicy(target), env), policy_of(TablePolicy(behavior), env)
    state = int(env.reset(seed=seed)[0])
    while True:
        answer = acts(state, [state])
        action = sampled(answer, rng)
        rho = probability(follows(state, [state]), action) / probability(answer, action)
        next_state, reward, terminated, truncated, _ = env.step(action)
        over = terminated or truncated
        yield Transition(state, float(reward), int(next_state), terminated, over, rho)
        state = int(env.reset()[0]) if over else int(next_state)


def weights_by_step(
    method: OffPolicyUpdate, features: NDArray[np.float64], steps: Iterable[Transition]
) -> NDArray[np.float64]:
    """Returns the weights before the first step and after each one, (steps + 1, d).

    Args:
        method: The method, with its initial weights.
        features: (states, d): the feature vectors.
        steps: The steps, from :func:`transitions`.
    """
    weights = [method.w.copy()]
    method.start_episode()
    for step in steps:
        next_x = np.zeros(features.shape[1]) if step.terminated else features[step.next_state]
        method.update(features[step.state], step.reward, next_x, step.rho)
        weights.append(method.w.copy())
        if step.over:
            method.start_episode()
    return np.array(weights)
