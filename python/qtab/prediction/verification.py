"""The comparison of estimated values with the same method in plain NumPy, in Gymnasium's environment."""

from contextlib import AbstractContextManager, closing, nullcontext
from dataclasses import dataclass
from typing import TYPE_CHECKING

import gymnasium as gym
import numpy as np

from qtab._utils import checks, html
from qtab._utils.arrays import same_bytes
from qtab._utils.fields import with_fields
from qtab._utils.shown import counted, shown
from qtab.config.config import replace_checked
from qtab.prediction.reference import estimate
from qtab.training.setup.run_env import check_described, limited, make_run_env

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
        compared = f"seed {self.seed}, {counted(self.episodes, 'episode')}"
        return f"<ValuesVerification of {self.method} in {self.env}: {compared}, {found}>"

    def _repr_html_(self) -> str:
        """The result as a table, for notebooks."""
        facts = {"compared": counted(self.episodes, "episode"), "weights": "equal" if self.equal else "DIFFERENT"}
        return html.summary(f"Verification of {self.method} in {self.env}, seed {self.seed}", facts)


def verify_values(
    estimates: "ValueEstimates", episodes: int | None = None, seed: int | None = None, env: gym.Env | None = None
) -> ValuesVerification:
    """Compares a run of some estimates with plain NumPy; see :meth:`qtab.ValueEstimates.verify`."""
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
        opened: AbstractContextManager[gym.Env] = closing(make_run_env(config, of="gymnasium"))
    else:
        if not isinstance(env, gym.Env):
            raise TypeError(f"env must be an environment, got {shown(env)}")
        check_described(config, env, "estimates")
        opened = nullcontext(limited(config, env, "estimates"))
    with opened as made:
        weights = estimate(made, replace_checked(config, seed=number), estimates, count)
    ours = estimates.weights[estimates.seeds.index(number), found[0]]
    return ValuesVerification(config.env, estimates.settings.method, number, count, same_bytes(ours, weights))
