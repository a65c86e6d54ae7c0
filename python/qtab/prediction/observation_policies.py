"""Policies that choose by the observation of a Box: functions, the greedy policies of runs, optima found by search."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from qtab._spec import ObservationPolicySpec
from qtab._utils.shown import shown
from qtab.config.options import WEIGHTED
from qtab.discretizers import Discretizer
from qtab.discretizers.box import BoxDiscretizer
from qtab.envs.actions import Actions
from qtab.planning.optimum import Optimum
from qtab.planning.policies import (
    GivenPolicy,
    answered,
    as_followed,
    equal_probabilities,
    probabilities,
    refuse_time_aware,
)
from qtab.results.action_values import masked_tables, of_observations
from qtab.results.run import Run


@dataclass(frozen=True, eq=False)
class TablePolicy:
    """Probabilities for each cell, or the same everywhere."""

    probabilities: NDArray[np.float64]
    """(cells, actions), or (1, actions)."""

    def spec(self) -> ObservationPolicySpec:
        """Returns the policy in the form that the extension reads."""
        return {"type": "table", "probabilities": self.probabilities}


@dataclass(frozen=True, eq=False)
class GreedyPolicy:
    """The greedy policy of a run."""

    run: Run

    @property
    def tables(self) -> NDArray[np.float64]:
        """The action values, (tables, rows, actions). Their sums over tables and active features are compared."""
        return np.ascontiguousarray(masked_tables(self.run))

    def spec(self) -> ObservationPolicySpec:
        """Returns the policy in the form that the extension reads."""
        return {"type": "greedy", "discretizer": self.run.discretizer.spec(), "tables": self.tables}


@dataclass(frozen=True, eq=False)
class FunctionPolicy:
    """A function from an observation to an action or to the probabilities of all actions."""

    name: str
    """The name of the argument, for messages."""
    function: Callable[[Any], Any]
    actions: Actions

    def spec(self) -> ObservationPolicySpec:
        """Returns the policy in the form that the extension reads."""
        return {
            "type": "function",
            "function": self.function,
            "read": lambda answer, observation: answered(self.name, answer, observation, self.actions),
            "first_action": self.actions.first,
        }


ObservationPolicy: TypeAlias = TablePolicy | GreedyPolicy | FunctionPolicy


@dataclass(frozen=True, eq=False)
class ObservationPolicies:
    """The policy that acts, and the policy that is evaluated: the same, except off policy."""

    target: ObservationPolicy
    behavior: ObservationPolicy

    def spec(self) -> Mapping[str, ObservationPolicySpec | None]:
        """Returns the policies in the form that the extension reads."""
        target = None if self.target is self.behavior else self.target.spec()
        return {"target": target, "behavior": self.behavior.spec()}


def reads_observations(policy: GivenPolicy, cells: Discretizer) -> bool:
    """Whether a policy must read the observations, because it does not choose by the cells of a discretizer."""
    if not isinstance(cells, BoxDiscretizer):
        return False
    if not cells.has_cells:
        return True
    if isinstance(policy, Run):
        return callable(policy.config.action_mask) or not same_cells(policy.discretizer, cells)
    if isinstance(policy, Optimum):
        return policy.search is not None
    return callable(policy)


def same_cells(one: Discretizer, other: Discretizer) -> bool:
    """Whether two discretizers find the same cells for every observation."""
    if not (one.has_cells and other.has_cells) or one.reads_space or other.reads_space:
        return False
    mine, theirs = one.spec(), other.spec()
    return mine.keys() == theirs.keys() and all(
        np.array_equal(mine[name], theirs[name])  # type: ignore[literal-required]
        if name != "edges"
        else all(map(np.array_equal, mine["edges"], theirs["edges"]))  # type: ignore[typeddict-item]
        for name in mine
    )


def observation_policy(name: str, policy: GivenPolicy, cells: Discretizer, actions: Actions) -> ObservationPolicy:
    """Returns a policy in a form that reads observations.

    Args:
        name: The name of the argument, for messages.
        policy: The policy given; see :func:`qtab.estimate_values`.
        cells: The discretizer of the values.
        actions: The actions.

    Raises:
        TypeError: if it is not a policy.
        ValueError: if it does not fit the observations or the actions.
    """
    if isinstance(policy, str):
        return TablePolicy(equal_probabilities(name, policy, 1, len(actions)))
    if isinstance(policy, Run):
        return _of_run(name, policy, cells, actions)
    if isinstance(policy, Optimum):
        return FunctionPolicy(name, _function_of_optimum(name, policy, actions), actions)
    if callable(policy):
        return FunctionPolicy(name, policy, actions)
    if not cells.has_cells:
        kind = "weighted features" if cells.is_weighted else "tile coding"
        lack = "have" if cells.is_weighted else "has"
        raise ValueError(
            f"{name} must be a function, a run, an optimum or 'random' for {kind}, which {lack} no cells, got "
            f"{shown(policy)}"
        )
    return TablePolicy(as_followed(probabilities(name, policy, None, cells, actions)))


def _of_run(name: str, run: Run, cells: Discretizer, actions: Actions) -> GreedyPolicy | FunctionPolicy:
    refuse_time_aware(name, run)
    theirs = run.discretizer
    if not isinstance(theirs, BoxDiscretizer) or theirs.spec()["type"] not in ("round", "bins", "tiles", *WEIGHTED):
        raise ValueError(f"{name} must be a run with a discretizer of Box observations, got {theirs!r}")
    if theirs.low.shape != cells.low.shape or theirs.low.dtype != cells.low.dtype:
        raise ValueError(
            f"{name} must be a run with observations of shape {cells.low.shape} and dtype {cells.low.dtype}, got "
            f"{theirs.low.shape} and {theirs.low.dtype}"
        )
    if not same_actions(run.actions, actions):
        raise ValueError(f"{name} must be a run with the actions {actions!r}, got {run.actions!r}")
    if callable(run.config.action_mask):  # the actions of an observation need not be those of its cell
        return FunctionPolicy(name, lambda at: int(np.argmax(of_observations(run, at))) + actions.first, actions)
    if run.config.action_mask is not False and run.action_masks is None:
        raise ValueError(
            f"{name} must be a run that knows its action masks, got action_mask={shown(run.config.action_mask)} with "
            f"{theirs!r}, which has no cells to keep masks for"
        )
    return GreedyPolicy(run)


def same_actions(one: Actions, other: Actions) -> bool:
    """Whether the columns of two tables stand for the same actions."""
    if one.values is None or other.values is None:
        return one.values is other.values and (one.count, one.first) == (other.count, other.first)
    return np.array_equal(one.values, other.values)


def _function_of_optimum(name: str, optimum: Optimum, actions: Actions) -> Callable[[Any], Any]:
    """Returns the best known policy as a function from an observation to the number of an action."""
    if optimum.search is None:
        raise ValueError(f"{name} must be an optimum for Box observations, got one for {optimum.env}")
    choices = actions.values
    if choices is None:
        return lambda observation: optimum.predict(observation)[0]

    def column(observation: Any) -> int:
        action = optimum.predict(observation)[0]
        distances = np.abs(choices - action).reshape(len(choices), -1).max(axis=-1)
        nearest = int(np.argmin(distances))
        # The optimum's torques and equally spaced actions may differ in their last digits.
        if not np.allclose(choices[nearest], action):
            raise ValueError(
                f"actions must hold those of the optimum, of which {shown(action.tolist())} is one, got {actions!r}: "
                f"actions={optimum.q_values.shape[-1]} does"
            )
        return nearest

    return column
