"""A check that episodes begin with the same distribution after an earlier episode."""

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from qtab.envs.tabulation.state_keys import NotComparableError, attributes_key, state_key
from qtab.envs.tabulation.walk import Visit


@dataclass(frozen=True, eq=False)
class Reset:
    """All outcomes of a reset.

    Args:
        before: The environment before the reset.
        visits: Its copies after the reset, with their probabilities.
        attributes: A function that returns the attributes of a copy that make its state.
    """

    before: Any
    visits: Sequence[tuple[Fraction, Visit]]
    attributes: Callable[[Any], dict[str, Any]]

    def touched(self) -> set[str]:
        """Returns the names of the attributes that the reset sets to another value than before."""
        envs = [visit.state for _, visit in self.visits]
        names = {name for env in (self.before, *envs) for name in self.attributes(env)}
        return {name for name in names if any(self._key(env, [name]) != self._key(self.before, [name]) for env in envs)}

    def distribution(self, names: Sequence[str], *, seen: bool) -> dict[Hashable, Fraction]:
        """Returns the probabilities of the values of some attributes, and of the observations and masks if ``seen``."""
        sums: dict[Hashable, Fraction] = {}
        for chance, visit in self.visits:
            key = self._key(visit.state, names), _seen(visit) if seen else None
            sums[key] = sums.get(key, Fraction(0)) + chance
        return sums

    def _key(self, env: Any, names: Sequence[str]) -> Hashable:
        attributes = self.attributes(env)
        try:
            return attributes_key(env, {name: attributes[name] for name in names if name in attributes})
        except NotComparableError:  # before a reset
            return object()


def difference(first: Reset, later: Reset) -> str | None:
    """Returns what a reset after an episode does differently than the first reset, in words; None if nothing.

    Probabilities, observations, masks, and the attributes that one of the resets changed are compared. Attributes that
    neither changed may differ.

    Args:
        first: The first reset.
        later: A reset of a copy after an episode.
    """
    names = sorted(first.touched() | later.touched())
    for name in names:
        if first.distribution([name], seen=False) != later.distribution([name], seen=False):
            return f"sets self.{name} to other values, or with other probabilities"
    if first.distribution(names, seen=True) != later.distribution(names, seen=True):
        return "returns other observations or masks, or begins with other probabilities"
    return None


def _seen(visit: Visit) -> Hashable:
    mask = None if visit.mask is None else visit.mask.tobytes()
    try:
        return state_key(visit.observation), mask
    except NotComparableError:
        return None, mask
