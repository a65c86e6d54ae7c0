"""``qtab.resume``: continues a run exactly where it stopped."""

import os
from collections.abc import Sequence

import gymnasium as gym

from qtab.results.run import Run
from qtab.training.callbacks import CALLBACK_EVERY, Callbacks, TrainingOptions
from qtab.training.earlier_run import counts_visits, earlier_run, has_finished, resolve_again
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
    """Continues a run that was stopped early, or extends a finished run to more episodes.

    With the same number of episodes, the result equals the uninterrupted run bit for bit, including its visits and
    snapshots, even if the run was stopped in the middle of an episode. With more episodes, schedules such as a falling
    ε are spread over all of them, as if the run had had so many from the start: ε rises again from the value at which
    it stopped, and the returns may become worse at first. The logger ``qtab`` reports this. To keep ε low, train on
    from the table instead: ``qtab.train(config=run.config.replace(episodes=1000, epsilon=0.0, seed=run.config.seed + 1,
    initial_q=run.tables))``. A falling learning rate starts again in that run. Training the config of an extended run
    again gives different numbers, and :func:`qtab.verify` and :func:`qtab.explain` can repeat only the episodes before
    the extension.

    An environment that is stepped in Python is resumed with its next episode, since qtab cannot restore its state
    within an episode. The result is that of the uninterrupted run if the run was stopped between two episodes and the
    environment keeps nothing from one episode to the next but its ``np_random``. A message is logged if the run was
    stopped within an episode.

    ``qtab.train(..., resume=run)`` does the same, and checks that other settings given are those of the run.

    Args:
        run: The run, or the path of a file that :meth:`qtab.Run.save` wrote.
        episodes: The number of episodes of the whole run, including the finished ones. None takes that of the run.
            More than the run's let a falling ε rise again.
        env: The environment, for a run whose environment qtab cannot make again. It is not closed. It must be the one
            that the run was trained on, with the same arguments, wrappers, changed attributes and spaces, and no
            shorter time limit. None makes it again.
        callback: As for :func:`qtab.train`; it receives the progress of the whole run.
        callback_every: As for :func:`qtab.train`.
        record: As for :func:`qtab.train`.
        snapshots: Additional snapshots, as for :func:`qtab.train`. Of evenly spaced ones, those after the finished
            episodes are taken.
        progress: As for :func:`qtab.train`.
        memory_limit: As for :func:`qtab.train`.

    Returns:
        The whole run. Its first episodes are those of ``run``, which is not changed. Visits are counted if ``run`` has
        them, and snapshots are added to those of ``run``. A run that has all its episodes is returned unchanged, and
        a message is logged.

    Raises:
        OSError: if the file cannot be read.
        TypeError: for an argument of the wrong type.
        ValueError: for a file that is not a run, a run that cannot be resumed, or an environment other than the
            run's; the message gives the reason.
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
