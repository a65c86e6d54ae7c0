"""The training of ``qtab train`` and ``qtab resume``, and their reports of the run."""

from collections.abc import Callable
from contextlib import closing
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from qtab._utils.shown import last_of
from qtab.cli.outputs import Outputs
from qtab.cli.reporting import Report
from qtab.config import Config
from qtab.config.presets import presets
from qtab.envs.metadata.goals import BEST_KNOWN_MOUNTAIN_CAR, has_quick_optimum, is_usual_mountain_car
from qtab.results.run import Run
from qtab.results.summary import FINAL_EPISODES, SOLVED_EPISODES, best_mean_returns, default_block, summarize
from qtab.training.callbacks import TrainingOptions
from qtab.training.progress import Progress
from qtab.training.setup.resolved_run import ResolvedRun
from qtab.training.setup.run_env import make_run_env
from qtab.training.train import train_resolved
from qtab.training.verdict import Verdict, judge

if TYPE_CHECKING:
    from qtab.planning import Gap, Optimum


OPTIMUM = "Report how far the run is from the optimum, and draw it. Always done for small tables."
"""The help of ``--optimum``."""


def backend_words(config: Config) -> str:
    """Returns the environment and the backend that steps it, as text."""
    return f"{config.env} {'stepped by Gymnasium in Python' if config.backend == 'gymnasium' else 'in Rust'}"


def optimum_of(resolved: ResolvedRun, always: bool, progress: bool | None) -> "Optimum | None":
    """Returns the optimum of a run's environment; None if it takes more than a second, unless ``always`` is set."""
    config = resolved.config
    rows, actions = resolved.discretizer.n_rows, len(resolved.actions)
    if not (always or has_quick_optimum(config, rows, actions)):
        return None
    from qtab.planning import optimum
    from qtab.planning.solve import quick_optimum

    if not always:
        return quick_optimum(config, rows, actions)
    with closing(make_run_env(config, of="gymnasium")) as env:
        return optimum(env, max_episode_steps=config.max_episode_steps, progress=progress)


@dataclass(frozen=True)
class Training:
    """A run to train, and its output files."""

    resolved: ResolvedRun
    report: Report
    outputs: Outputs
    best: "Optimum | None"
    """The optimum of the environment, if it is known."""
    visits: bool = False
    snapshots: tuple[int, ...] = ()
    earlier: Run | None = None
    """The run that is resumed."""

    def run(self) -> None:
        """Trains and reports. An interrupted run is reported, saved and plotted as well.

        Raises:
            Exception: any error of the training.
        """
        block = default_block(self.resolved.config.episodes)
        done = 0 if self.earlier is None else len(self.earlier.episode_returns)
        averages = _averages(self.report, block, done // block * block)
        options = TrainingOptions(
            callback=(*self.outputs.callbacks, averages),
            callback_every=block,
            record=self.outputs.shown,
            visits=self.visits,
            snapshots=self.snapshots or None,
            progress=self.report.progress,
        )
        try:
            finished = train_resolved(self.resolved, options, self.earlier)
        except BaseException as error:
            partial = getattr(error, "run", None)
            if isinstance(partial, Run):
                try:
                    self.keep_and_report(partial, averages)
                except ValueError as problem:  # values that overflowed are not saved
                    self.report.problem(problem)
            raise
        self.keep_and_report(finished)
        self.outputs.show(finished)
        self.report.add(files=self.outputs.files)

    def keep_and_report(self, run: Run, averages: Callable[[Progress], None] | None = None) -> None:
        """Saves and plots a run before anything is printed, and then reports it; an interrupted one with its averages.

        Raises:
            Exception: any error of saving, after the report.
        """
        try:
            self.outputs.keep(run, self.best)
        finally:
            if averages is not None:
                done, total = len(run.episode_returns), run.config.episodes
                averages(Progress(done, total, run.episode_returns, run.episode_lengths))
                self.report.text(f"Stopped after {done:,} of {total:,} episodes; what was learned so far:")
            self._report(run)

    def _report(self, run: Run) -> None:
        gap, verdict = None if self.best is None else self.best.gap(run), judge(run, self.best)
        self.report.add(**_summary(run, verdict, gap), files=self.outputs.files)
        for line in (_summary_text(run), _verdict_text(run, verdict), _gap_text(run, gap), *self.outputs.written):
            if line is not None:
                self.report.text(line)


def _averages(report: Report, block: int, printed: int) -> Callable[[Progress], None]:
    """Returns a callback that prints the average return of each block of episodes, as the article does."""

    def callback(progress: Progress) -> None:
        nonlocal printed
        while printed + block <= progress.episodes:
            average = float(progress.returns[printed : printed + block].mean())
            report.text(f"Episode {printed + block} Average Reward: {round(average, 4)}")
            printed += block  # last, so that a line cut off by Ctrl-C is printed again

    return callback


def _summary_text(run: Run) -> str:
    returns, steps = run.episode_returns[-FINAL_EPISODES:], int(run.episode_lengths.sum())
    if len(returns) == 0:
        return f"No episode was finished in {run.seconds:.3g} s"
    speed = f" ({steps / run.seconds:,.0f} steps/s)" if run.seconds > 0 else ""
    took = f"{steps:,} steps in {run.seconds:.3g} s{speed}"
    return f"Mean return over the {last_of(len(returns), 'episode')}: {returns.mean():.2f}; {took}"


def _best_mean(run: Run) -> float | None:
    """Returns the best mean return over 100 consecutive episodes; None if there are fewer."""
    if len(run.episode_returns) < SOLVED_EPISODES:
        return None
    return float(best_mean_returns(run.episode_returns[np.newaxis])[0])


def _final_return(run: Run) -> float:
    last = run.episode_returns[-FINAL_EPISODES:]
    return float(last.mean()) if len(last) else float("nan")


def _verdict_text(run: Run, verdict: Verdict) -> str | None:
    """Describes whether the run solved its task, and the preset that does; None if nothing defines that."""
    if verdict.solved is None:
        return None if verdict.goal.registered is None else f"Not known whether solved: {verdict.why_unknown}"
    if verdict.solved:
        return f"Solved: {verdict}"
    text, best, goal = f"Not solved: {verdict}", _best_mean(run), verdict.goal
    if best is not None and goal.least is not None and best >= goal.least:
        text += f"; the best {SOLVED_EPISODES} consecutive episodes {best:.4g}"
    is_for_this = goal.threshold is not None or goal.registered is None
    solving = is_for_this and "solved" in presets(run.config.env) and run.config.preset != "solved"
    return text + ("; --preset solved reaches it" if solving else "")


def _gap_text(run: Run, gap: "Gap[float] | None") -> str | None:
    """Describes the gap to the optimum; None if it is not known, or only by a search."""
    if gap is not None:
        text = str(gap)
        return text[0].upper() + text[1:]
    if not is_usual_mountain_car(run.config) or not len(run.episode_returns):
        return None
    last = f"the {last_of(min(len(run.episode_returns), FINAL_EPISODES), 'episode')}"
    short = BEST_KNOWN_MOUNTAIN_CAR - _final_return(run)
    return f"Best known {BEST_KNOWN_MOUNTAIN_CAR:.4g}, gap {short:.4g} over {last}"


def _summary(run: Run, verdict: Verdict, gap: "Gap[float] | None") -> dict[str, Any]:
    """Returns the JSON object of a run; the page on the command line lists its keys."""
    finished = len(run.episode_returns)
    columns = summarize(run.episode_returns[None], run.episode_lengths[None], run.terminated[None]) if finished else {}
    numbers = {name: column.item() for name, column in columns.items()}
    return {
        "env": run.config.env,
        "seed": run.config.seed,
        "settings": {
            name: {"shape": value.shape} if isinstance(value, np.ndarray) else value
            for name, value in vars(run.config).items()
        },
        "completed": run.completed,
        "episodes": finished,
        "steps": int(run.episode_lengths.sum()),
        "seconds": run.seconds,
        **{name: numbers.get(name) for name in ("mean_return", "final_return", "best_return", "terminated_rate")},
        "best_mean_return": _best_mean(run),
        **verdict.numbers(),
        "gap": _gap_facts(run, gap),
        "versions": run.versions,
    }


def _gap_facts(run: Run, gap: "Gap[float] | None") -> dict[str, Any] | None:
    names = ("label", "optimum", "final", "greedy", "greedy_return", "attainable", "standard_error")
    if gap is not None:
        return {name: getattr(gap, name) for name in names}
    if not is_usual_mountain_car(run.config):
        return None
    final = BEST_KNOWN_MOUNTAIN_CAR - _final_return(run)
    return {**dict.fromkeys(names), "label": "best known", "optimum": BEST_KNOWN_MOUNTAIN_CAR, "final": final}
