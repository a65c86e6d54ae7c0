"""``qtab optimum``."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

import tyro

from qtab._utils.progress import print_above
from qtab.cli.constructors import PAIRS
from qtab.cli.parsing import parse
from qtab.cli.usage import refusing
from qtab.config import Config
from qtab.planning import optimum

COMMAND = "qtab optimum"


@dataclass(frozen=True)
class Arguments:
    """Compute the best that can be returned in an environment: exactly from its table, or the best that is known."""

    env: tyro.conf.Positional[str] = Config.env
    """Gymnasium's id of the environment."""
    env_kwargs: Annotated[Mapping[str, Any], PAIRS] = field(default_factory=dict)
    """Keyword arguments of the environment's constructor."""
    max_episode_steps: int | None = None
    """The time limit; the environment's own, or 10,000 where it has none."""
    discount: float | None = None
    """What the values and the policy count a later reward; 1, no discount, where it is not given."""
    method: str | None = None
    """finite_horizon (the default with a table), value_iteration or policy_iteration; search for MountainCar-v0."""


def run(arguments: list[str]) -> int:
    """Computes and prints as the arguments say; returns the exit code."""
    asked = parse(Arguments, COMMAND, arguments)
    with refusing():
        found = optimum(
            asked.env,
            discount=asked.discount,
            max_episode_steps=asked.max_episode_steps,
            method=asked.method,
            env_kwargs=asked.env_kwargs,
        )
    print_above(str(found))
    return 0
