"""``EvaluateEvery``: evaluates the greedy policy at intervals during a run."""

from bisect import bisect_right
from typing import TYPE_CHECKING

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from qtab._utils import checks
from qtab.config import Config
from qtab.training.callbacks import BaseCallback
from qtab.training.evaluate import Evaluation, evaluate
from qtab.training.progress import Progress
from qtab.training.setup.run_env import make_run_env

if TYPE_CHECKING:
    from qtab.results.run import Run


class EvaluateEvery(BaseCallback):
    """Plays episodes with the greedy policy, without exploration and without learning, at intervals and at the end.

    They use a separate environment with a separate random generator: the run is the same as without them, bit for bit.

    If a run is resumed with the object that evaluated its earlier part, the evaluations continue. A new object has
    only those of the resumed part.

    Args:
        episodes: The number of episodes of each evaluation.
        every: The number of training episodes between two evaluations; None takes ``callback_every``.
        seed: The seed of the environment, the same in every evaluation, so that only the policy differs. None
            derives one from the seed of the run.
        env: The environment to evaluate in; None makes the run's again, with its wrappers and changed attributes.

    Attributes:
        evaluated_at: The number of finished training episodes at each evaluation.
        evaluations: The evaluations, in the same order.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """

    def __init__(
        self,
        episodes: int = 20,
        every: int | None = 1000,
        *,
        seed: int | None = None,
        env: gym.Env | None = None,
    ) -> None:
        super().__init__(every)
        self.episodes = checks.count("episodes", episodes, least=1)
        self.seed = None if seed is None else checks.integer("seed", seed, least=0)
        if env is not None and not isinstance(env, gym.Env):
            raise TypeError(f"env must be an environment, got {env!r}")
        self.env = env
        self.evaluated_at: list[int] = []
        self.evaluations: list[Evaluation] = []
        self._config: Config | None = None
        """The config of the run that was evaluated last."""

    @property
    def mean_returns(self) -> NDArray[np.float64]:
        """(evaluations,): the mean return of each evaluation."""
        return np.array([evaluation.mean_return for evaluation in self.evaluations], dtype=np.float64)

    def on_start(self, config: Config, env: gym.Env | None) -> None:
        """Discards the evaluations of an earlier run.

        Raises:
            ValueError: if there is no environment to evaluate in except the one that is trained in.
        """
        self.evaluated_at, self.evaluations, self._config = [], [], config
        if self.env is None:
            _require_another(config)
        elif env is not None and self.env.unwrapped is env.unwrapped:
            raise ValueError("env must not be the environment that is trained in, got the same one")

    def on_resume(self, config: Config, env: gym.Env | None, earlier: "Run") -> None:
        """Continues the evaluations of the earlier part, up to its last episode, if this object made them.

        Raises:
            ValueError: as for :meth:`on_start`.
        """
        finished = len(earlier.episode_returns) if self._config == earlier.config else 0
        kept = bisect_right(self.evaluated_at, finished)
        evaluated_at, evaluations = self.evaluated_at[:kept], self.evaluations[:kept]
        self.on_start(config, env)
        self.evaluated_at, self.evaluations = evaluated_at, evaluations

    def __call__(self, progress: Progress) -> bool | None:
        """Evaluates the greedy policy."""
        self.evaluations.append(self._evaluate(progress.run))
        self.evaluated_at.append(progress.episodes)
        return None

    def _evaluate(self, run: "Run") -> Evaluation:
        seed = _evaluation_seed(run.config) if self.seed is None else self.seed
        return evaluate(run, self.episodes, seed, self.env, progress=False)


def _require_another(config: Config) -> None:
    try:
        make_run_env(config).close()
    except ValueError:  # its message already asks for env=
        raise
    except Exception as error:
        raise ValueError(f"env must be given: no other environment can be made from {config.env!r}") from error


def _evaluation_seed(config: Config) -> int:
    """Returns a seed that is derived from the run's seed, with unrelated bits."""
    child = np.random.SeedSequence(config.seed).spawn(1)[0]
    return int(child.generate_state(1)[0])
