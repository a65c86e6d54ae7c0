"""``qtab.resume``: continues a run exactly where it stopped."""

import os
from collections.abc import Sequence

import gymnasium as gym

from qtab.results.run import Run
from qtab.training.callbacks import Callbacks
from qtab.training.earlier_run import counts_visits, earlier_run, has_finished, resolve_again
from qtab.training.options import CALLBACK_EVERY, TrainingOptions
from qtab.training.train import train_resolved


def resume(
    run: "Run | str | os.PathLike[str]",
    episodes: int | None = None,
    env: gym.Env | None = None,
    *,
    callback: Callbacks | None = None,
    callback_every: int = CALLBACK_EVERY,
    record: int = 0,
    snapshots: int | Sequence[int] | None = None,
    progress: bool | None = None,
    memory_limit: int | None = None,
) -> Run:
    """Continues a run that was stopped early, or trains one that has finished for more episodes.

    With the same number of episodes, the result is what the uninterrupted run would have been, bit for bit, even if it
    was stopped in the middle of an episode; its visits and snapshots, too. With more episodes, what changes over the
    course of a run, such as a falling ε, is spread over all of them, as if the run had had so many from the start: ε
    continues from another value than the one at which it stopped. A message of the logger ``qtab`` then says so.
    Training the config of such a run again gives other numbers, and :func:`qtab.verify` and :func:`qtab.explain` can
    repeat only the episodes before.

    An environment that is stepped in Python is resumed with its next episode, since the state within an episode is the
    environment's own. The result is that of the uninterrupted run if it was stopped between two episodes and the
    environment keeps nothing from one episode to the next but its ``np_random``; a message says where it was not.

    ``qtab.train(..., resume=run)`` does the same, and checks that the settings given beside it are those of the run.

    Args:
        run: The run, or the path of a file that :meth:`qtab.Run.save` wrote.
        episodes: The number of episodes of the whole run, those that are finished included. None takes that of the run.
        env: The environment, where that of the run cannot be made again. It is not closed. It must be the one that the
            run was trained on, with the same arguments, wrappers, changed attributes and spaces, and no shorter time
            limit. None makes it again.
        callback: As for :func:`qtab.train`; it sees the whole run.
        callback_every: As for :func:`qtab.train`.
        record: As for :func:`qtab.train`.
        snapshots: More snapshots, as for :func:`qtab.train`, besides those that the run has taken or still has to take.
            Of evenly spaced ones, those after the finished episodes are taken.
        progress: As for :func:`qtab.train`.
        memory_limit: As for :func:`qtab.train`.

    Returns:
        The whole run. Its first episodes are those of ``run``, which stays as it is. Visits are counted on if they were
        counted, and snapshots are added to those of ``run``. A run that has all its episodes is returned as it is, and
        a message says so.

    Raises:
        OSError: if the file cannot be read.
        TypeError: for an argument of the wrong type.
        ValueError: for a file that is not a run, a run that cannot be resumed, or an environment other
            than the run's: it says why.
        KeyboardInterrupt: on Ctrl-C. Like any exception raised by the environment or the callback, it carries the run
            so far as ``.run``, which can be resumed again.
    """
    earlier = earlier_run("run", run)
    if env is not None and not isinstance(env, gym.Env):
        raise TypeError(f"env must be an environment, got {env!r}")
    visits = counts_visits(earlier, False)
    options = TrainingOptions(callback, callback_every, record, visits, snapshots, progress, memory_limit)
    if has_finished(earlier, episodes, options):
        return earlier
    resolved = resolve_again("run", earlier, episodes, env)
    try:
        return train_resolved(resolved, options, earlier)
    finally:
        resolved.close()
