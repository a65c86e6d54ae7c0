"""``qtab optimum``."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

import tyro

from qtab.cli.constructors import OPTIONAL_FLOAT, OPTIONAL_INT, PAIRS
from qtab.cli.parsing import parse
from qtab.cli.reporting import OutputFlags, Report
from qtab.cli.usage import usage_errors
from qtab.config import Config
from qtab.planning import optimum

COMMAND = "qtab optimum"
FACTS = (
    *("env", "env_kwargs", "max_episode_steps", "discount", "method", "exact", "label"),
    *("expected_return", "reward_threshold", "seconds"),
)
"""What the JSON object holds."""


@dataclass(frozen=True)
class Arguments(OutputFlags):
    """Compute the best policy of an environment: exact from its transition table, or the best known."""

    env: tyro.conf.Positional[str] = Config.env
    """Gymnasium's id of the environment."""
    env_kwargs: Annotated[Mapping[str, Any], PAIRS] = field(default_factory=dict)
    """Keyword arguments of the environment's constructor."""
    max_episode_steps: Annotated[int | None, OPTIONAL_INT] = None
    """The time limit in steps; by default the environment's own, or 10,000 if it has none."""
    discount: Annotated[float | None, OPTIONAL_FLOAT] = None
    """The discount of the values and the policy; by default 1, no discount."""
    method: str | None = None
    """With a table, finite_horizon (the default), value_iteration or policy_iteration; for classic control, search."""


def run(arguments: list[str]) -> int:
    """Runs the command and returns its exit code."""
    options = parse(Arguments, COMMAND, arguments)
    with Report(COMMAND, options) as report:
        with usage_errors(("max_episode_steps", "discount", "method", "env_kwargs"), "env"):
            result = optimum(
                options.env,
                discount=options.discount,
                max_episode_steps=options.max_episode_steps,
                method=options.method,
                env_kwargs=options.env_kwargs,
                progress=report.progress,
            )
        report.text(str(result))
        report.add(**{name: getattr(result, name) for name in FACTS})
    return 0
