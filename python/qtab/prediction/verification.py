"""The comparison of estimated values with the same method in plain NumPy, in Gymnasium's environment."""

from contextlib import closing
from dataclasses import dataclass
from typing import TYPE_CHECKING

import gymnasium as gym
import numpy as np

from qtab._utils import checks, html
from qtab._utils.arrays import same_bytes
from qtab._utils.fields import with_fields
from qtab._utils.shown import shown
from qtab.config.config import replace_checked
from qtab.envs.registry import ENTRIES, gymnasium_id, spec_of_run
from qtab.prediction.reference import estimate

if TYPE_CHECKING:
    from qtab.prediction.estimates import ValueEstimates


@with_fields
@dataclass(frozen=True, repr=False)
class ValuesVerification:
    """The result of a comparison with Gymnasium and NumPy."""

    env: str
    method: str
    seed: int
    episodes: int
    """The number of episodes that were compared."""
    equal: bool
    """Whether the weights are equal byte for byte."""

    def __repr__(self) -> str:
        """A one-line summary."""
        found = "equal" if self.equal else "DIFFERENT"
        compared = f"seed {self.seed}, {self.episodes:,} episodes"
        return f"<ValuesVerification of {self.method} in {self.env}: {compared}, {found}>"

    def _repr_html_(self) -> str:
        """The result as a table, for notebooks."""
        facts = {"compared": f"{self.episodes:,} episodes", "weights": "equal" if self.equal else "DIFFERENT"}
        return html.summary(f"Verification of {self.method} in {self.env}, seed {self.seed}", facts)


def verify_values(
    estimates: "ValueEstimates", episodes: int | None, seed: int | None, env: gym.Env | None = None
) -> ValuesVerification:
    """Compares a run of some estimates with plain NumPy; see :meth:`qtab.ValueEstimates.verify`.

    Args:
        estimates: The estimates to verify.
        episodes: The number of episodes; None means all.
        seed: The seed of the run; None means the first.
        env: The environment, if it has no id. It is not closed.
    """
    config = estimates.config
    if config is None:
        raise ValueError("estimates from a file cannot be verified: their task is not in it")
    number = estimates.seeds[0] if seed is None else checks.integer("seed", seed, least=0)
    if number not in estimates.seeds:
        raise ValueError(f"seed must be one of those of the estimates, got {number}")
    count = int(estimates.episodes[-1]) if episodes is None else checks.count("episodes", episodes, least=0)
    found = np.flatnonzero(estimates.episodes == count)
    if not len(found):
        recorded = shown(estimates.episodes.tolist())
        raise ValueError(f"episodes must be one of those that were recorded, {recorded}, got {count}")
    if env is None:
        spec = spec_of_run(config.env)
        theirs = gymnasium_id(config.env)
        made = gym.make(
            theirs if theirs in ENTRIES else spec, max_episode_steps=config.max_episode_steps, **config.env_kwargs
        )
        with closing(made):
            return verify_values(estimates, episodes, seed, made)
    limited = (
        env
        if env.spec is not None
        else gym.wrappers.TimeLimit(env, checks.required("max_episode_steps", config.max_episode_steps))
    )
    weights = estimate(limited, replace_checked(config, seed=number), estimates, count)
    ours = estimates.weights[estimates.seeds.index(number), found[0]]
    return ValuesVerification(config.env, estimates.settings.method, number, count, same_bytes(ours, weights))
