"""How many runs take about a second, from the time that others took."""

from dataclasses import dataclass

from qtab.sweeps.study import Study
from qtab.training.resolved_run import ResolvedRun

CHUNK_SECONDS = 1.0
"""The time between two commits: what an interruption loses at most, unless single runs take longer."""
MAX_CHUNK_RUNS = 4096
"""The maximum number of runs in a chunk."""
TYPICAL_MAX_STEPS = 1000
"""Episodes with a longer time limit are expected to end before this many steps."""
CAUTION = 4.0
"""The factor by which another setting may take longer than predicted from the last one."""


@dataclass
class Pace:
    """Predicts the time of runs from those before.

    The estimated steps of a run make the times of different settings comparable. Predictions never change results: they
    only decide when results are stored.
    """

    seconds_per_step: float | None = None
    """The time of an estimated step in the last runs; None before the first."""
    setting: int | None = None
    """The setting of the last runs."""

    def record(self, setting: int, resolved: ResolvedRun, runs: int, seconds: float) -> None:
        """Records the time that runs of a setting took together."""
        self.setting, self.seconds_per_step = setting, max(seconds, 1e-9) / (runs * _steps(resolved))

    def runs(self, setting: int, resolved: ResolvedRun, seconds: float, at_least: int = 1) -> int:
        """Returns how many runs of a setting are expected to take so many seconds."""
        if self.seconds_per_step is None:
            return min(at_least, MAX_CHUNK_RUNS)
        predicted = self.seconds_per_step * _steps(resolved) * (1.0 if setting == self.setting else CAUTION)
        return min(max(int(min(seconds / predicted, MAX_CHUNK_RUNS)), at_least), MAX_CHUNK_RUNS)


def _steps(resolved: ResolvedRun) -> int:
    """Returns the estimated steps of a run."""
    return resolved.config.episodes * min(resolved.max_episode_steps, TYPICAL_MAX_STEPS)


def claim_size(study: Study, pace: Pace, at_least: int, start: int) -> int:
    """Returns how many runs of a study from an index are expected to take about a second.

    A few more do not matter: the training stops after a second, and releases the rest of a claim.
    """
    count = len(study.seeds)
    size, left = 0, CHUNK_SECONDS
    while size < MAX_CHUNK_RUNS and start + size < study.runs:
        setting = (start + size) // count
        of_setting = (setting + 1) * count - start - size
        predicted = pace.runs(setting, study.resolved[setting], left, at_least)
        size += min(of_setting, predicted)
        if predicted <= of_setting:
            break
        left *= 1 - of_setting / predicted
    return min(size, MAX_CHUNK_RUNS)
