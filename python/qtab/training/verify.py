"""``qtab.verify``: compares a run with Gymnasium's environment and the reference learners in NumPy, byte for byte."""

from collections.abc import Callable
from contextlib import AbstractContextManager, closing, nullcontext
from dataclasses import dataclass, replace
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.envs.registration import EnvSpec
from numpy.typing import NDArray

from qtab import _core
from qtab._utils import checks, html
from qtab._utils.arrays import same_bytes
from qtab._utils.fields import with_fields
from qtab._utils.memory import check_memory
from qtab._utils.shown import counted, shown
from qtab._utils.versions import versions
from qtab.config import Config
from qtab.config.unknown import suggesting
from qtab.reference import LEARNERS
from qtab.results.rates import ONLY_FIRST, repeatable
from qtab.results.run import Run
from qtab.training.repetition import repeats_itself, wrapper_with_statistics
from qtab.training.setup.resolve import resolve
from qtab.training.setup.run_env import check_env, check_same, limited, make_run_env, resolve_run


@with_fields
@dataclass(frozen=True, repr=False)
class Verification:
    """The result of a comparison with Gymnasium and NumPy."""

    env: str
    seed: int
    episodes: int
    """The number of compared episodes."""
    returns_equal: bool
    lengths_equal: bool
    table_equal: bool
    episode: int | None
    """The first episode (from 0) in which the two differ; None if none does."""
    step: int | None
    """The first step (from 0) of ``episode`` at which their actions differ; None if none does."""
    versions: dict[str, str]
    repeats: bool | None = None
    """Whether the environment gave the same results twice for the same seed and actions; None if nothing differs."""
    wrapper: str | None = None
    """The class name of a wrapper of ``env`` that keeps statistics; None without one or if nothing differs."""
    trained_with: dict[str, str] | None = None
    """The platform and versions of the run that differ from those of this comparison; None if nothing differs."""
    table_of_run: bool = True
    """Whether the Q table compared was the run's own. False if the run holds no table after exactly these episodes:
    only its first ones are compared, or it was stopped within one. The table then comes from training again."""

    @property
    def equal(self) -> bool:
        """Whether returns, lengths and the Q table (see :attr:`table_of_run`) are equal byte for byte."""
        return self.returns_equal and self.lengths_equal and self.table_equal

    def __repr__(self) -> str:
        """Returns one line; ``print`` shows the whole report."""
        episodes = counted(self.episodes, "episode")
        found = "equal" if self.equal else "DIFFERENT" + ("" if self.episode is None else f" from {self._place} on")
        return f"<Verification of {self.env}: seed {self.seed}, {episodes}, {found}>"

    def __str__(self) -> str:
        """Returns a report of several lines."""
        lines = [self._heading, *(f"  {name:7}  {word}" for name, word in self._words().items())]
        if self.episode is not None:
            lines.append(f"  they differ from {self._place} on (counted from 0)")
        if not self.table_of_run:
            lines.append(f"  the Q table is {self._other_table}")
        lines += [f"  {sentence}" for sentence in self._about_the_environment() + self._about_the_machine()]
        lines.append("  " + ", ".join(f"{name} {value}" for name, value in self.versions.items()))
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        """Returns the report as a table, for notebooks."""
        facts = {"compared": f"{counted(self.episodes, 'episode')}, byte for byte", **self._words()}
        if self.episode is not None:
            facts["they differ from"] = f"{self._place} on (counted from 0)"
        if not self.table_of_run:
            facts["Q table compared"] = self._other_table
        if self.repeats is not None:
            facts["environment"] = " ".join(self._about_the_environment())
        if self.trained_with:
            facts["trained with"] = " ".join(self._about_the_machine())
        return html.summary(f"Verification of {self.env}, seed {self.seed}", {**facts, **self.versions})

    def _about_the_environment(self) -> list[str]:
        """Returns lines of the report about the environment as a cause of the difference."""
        lines = []
        if self.repeats is False:
            lines.append("the environment does not repeat itself: the same seed and actions gave different results the")
            lines.append("second time, so the difference does not show a fault of qtab")
        elif self.repeats:
            lines.append("the environment repeats itself: the same seed and actions gave the same results twice")
        if self.wrapper is not None:
            lines.append(f"its wrapper {self.wrapper} keeps statistics from one call to the next:")
            lines.append("give train and verify a new environment each, and call verify without episodes=")
        return lines

    def _about_the_machine(self) -> list[str]:
        """Returns lines of the report about other libraries as a cause of the difference."""
        if not self.trained_with:
            return []
        trained_with = ", ".join(f"{name} {value}" for name, value in self.trained_with.items())
        return [
            f"the run was trained with {trained_with}: other libraries may round a sine or a cosine differently",
        ]

    @property
    def _heading(self) -> str:
        episodes = counted(self.episodes, "episode")
        return f"{self.env}, seed {self.seed}, {episodes} against Gymnasium and NumPy, byte for byte"

    @property
    def _other_table(self) -> str:
        return f"from training again in Rust: the run holds none after {counted(self.episodes, 'episode')}"

    @property
    def _place(self) -> str:
        return f"episode {self.episode}" + ("" if self.step is None else f", step {self.step}")

    def _words(self) -> dict[str, str]:
        compared = {"returns": self.returns_equal, "lengths": self.lengths_equal, "Q table": self.table_equal}
        return {name: "equal" if equal else "DIFFERENT" for name, equal in compared.items()}


@suggesting
def verify(
    run: Run,
    episodes: int | None = None,
    env: str | EnvSpec | gym.Env | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Verification:
    """Trains a run's config again with Gymnasium's environment and the reference learner in plain NumPy, and compares.

    If the two differ, the reference's actions are taken twice more, to find out whether the environment repeats itself.

    Args:
        run: The run to verify.
        episodes: The number of first episodes to compare, using the full run's schedule. The run holds no table of an
            earlier episode, so Rust trains again for the table to compare. None compares all episodes and the run's
            own Q table.
        env: The environment, for a run whose environment qtab cannot make again: an environment, which is not closed,
            an id or an EnvSpec. It must be the one that the run was trained on.
        progress: Called after every episode of the reference with the number done and the total.

    Raises:
        gymnasium.error.UnregisteredEnv: without ``env``, for a run whose environment is not registered.
        TypeError: for an argument of the wrong type.
        MemoryError: if the tables of the reference do not fit into the free memory.
        ValueError: for an argument out of range, an environment that is not that of the run, or an interrupted run
            without ``episodes``. If a run was resumed with more episodes and a falling rate, only the episodes before
            the extension can be compared.
    """
    checks.instance("run", run, Run)
    check_env(env)
    if progress is not None and not callable(progress):
        raise TypeError(f"progress must be callable, got {shown(progress)}")
    finished = len(run.episode_returns)
    run, most = repeatable(run)
    if episodes is None and not run.completed:
        raise ValueError(f"episodes must be given for a run that was stopped early, at most {most}")
    if episodes is None and most < finished:
        raise ValueError(
            f"episodes must be given for a run that was extended after {most:,} episodes: {ONLY_FIRST}; "
            f"episodes={most} compares them"
        )
    count = checks.integer("episodes", finished if episodes is None else episodes, least=1, most=finished)
    if count > most:
        raise ValueError(
            f"episodes must be at most {most:,} for a run that was extended after {most:,} episodes: {ONLY_FIRST}, "
            f"got {episodes!r}"
        )
    config = run.config
    if isinstance(env, gym.Env):
        check_same(run, env)
    elif env is not None:
        with closing(gym.make(env, max_episode_steps=run.config.max_episode_steps)) as made:
            return verify(run, episodes, made, progress)
    check_memory("the tables of the reference", 2 * run.tables.nbytes)
    recorder = _Recorder(_environment(config, env), count, progress)
    try:
        table, returns, lengths = LEARNERS[config.algorithm](recorder, config, stop_after=count)
        if progress is not None:
            progress(count, count)
    finally:
        if env is None:
            recorder.close()

    is_whole = count == finished and run.completed
    ours = run.tables if is_whole else _again(config, env, count)[0]
    episode = _first_difference((returns, run.episode_returns[:count]), (lengths, run.episode_lengths[:count]))
    verification = Verification(
        env=config.env,
        seed=checks.required("seed", config.seed),
        episodes=count,
        returns_equal=returns.tobytes() == run.episode_returns[:count].tobytes(),
        lengths_equal=lengths.tobytes() == run.episode_lengths[:count].tobytes(),
        table_equal=same_bytes(table, ours),
        episode=episode,
        step=None if episode is None else _first_step(config, env, run, recorder, episode),
        versions=versions(),
        # An unfinished episode changes the tables of a stopped run.
        table_of_run=is_whole or (count == finished and same_bytes(ours, run.tables)),
    )
    if verification.equal:
        return verification

    def make() -> AbstractContextManager[gym.Env]:
        again = _environment(config, env)
        return closing(again) if env is None else nullcontext(again)

    actions = recorder.actions if episode is None else recorder.actions[: episode + 1]
    return replace(
        verification,
        repeats=repeats_itself(make, verification.seed, actions, returns[: len(actions)].tolist()),
        wrapper=None if env is None else wrapper_with_statistics(env),
        trained_with={
            name: value
            for name, value in run.versions.items()
            if name in ("platform", "numpy", "gymnasium") and value != verification.versions[name]
        },
    )


def _environment(config: Config, env: gym.Env | None) -> gym.Env:
    """Returns Gymnasium's own environment, even if the id names qtab's."""
    if env is not None:
        return limited(config, env, "run")
    return make_run_env(config, of="gymnasium")


def _again(config: Config, env: gym.Env | None, episodes: int) -> tuple[NDArray[np.float64], list[Any]]:
    """Trains in Rust again; returns the table after ``episodes`` episodes, and the actions of the last one."""
    fields = _fields(config, env)
    resolved = resolve_run(config, fields) if env is None else resolve(env, fields)
    try:
        trainer = _core.Trainer(resolved.spec(), resolved.seed, record=1)
        trainer.advance(episodes)
        (_, columns) = trainer.take_recordings()[-1]
        return trainer.tables(), [resolved.actions[column] for column in columns.tolist()]
    finally:
        resolved.close()


def _fields(config: Config, env: gym.Env | None) -> dict[str, Any]:
    fields = {name: value for name, value in vars(config).items() if name != "env"}
    if env is not None:
        del fields["env_kwargs"]
        fields["backend"] = "gymnasium" if config.backend == "gymnasium" else "auto"
    return fields


def _first_difference(*pairs: tuple[NDArray[Any], NDArray[Any]]) -> int | None:
    """Returns the first index at which the arrays of any pair differ."""
    unequal = np.any([theirs != ours for theirs, ours in pairs], axis=0)
    return int(np.argmax(unequal)) if unequal.any() else None


def _first_step(config: Config, env: gym.Env | None, run: Run, recorder: "_Recorder", episode: int) -> int | None:
    theirs = recorder.actions[episode]
    _, ours = _again(config, env, episode + 1)
    for step, (one, other) in enumerate(zip(theirs, ours, strict=False)):
        if not np.array_equal(one, other):
            return step
    lengths = (len(theirs), len(ours), int(run.episode_lengths[episode]))
    return min(lengths) if min(lengths) < max(lengths) else None


class _Recorder(gym.Wrapper[Any, Any, Any, Any]):
    """Records every action, and reports the progress of the reference."""

    def __init__(self, env: gym.Env, total: int, progress: Callable[[int, int], None] | None) -> None:
        super().__init__(env)
        self.actions: list[list[Any]] = []
        self._total = total
        self._progress = progress

    def reset(self, **kwargs: Any) -> Any:
        if self.actions and self._progress is not None:
            self._progress(len(self.actions), self._total)
        self.actions.append([])
        return self.env.reset(**kwargs)

    def step(self, action: Any) -> Any:
        self.actions[-1].append(action)
        return self.env.step(action)
