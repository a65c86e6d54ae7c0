"""Train every setting of a study with the same seeds. An interrupted sweep resumes if it is called again."""

from argparse import Namespace
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import gymnasium as gym

from qtab._utils import checks
from qtab._utils.files import check_writable
from qtab._utils.shown import counted, shown
from qtab.cli.errors import UsageError, flag, one_line, usage_errors
from qtab.cli.parser import Parser
from qtab.cli.reporting import Report
from qtab.cli.study_file import read_study
from qtab.cli.values import integer
from qtab.sweeps import StoreError, Sweep, sweep
from qtab.sweeps.confirm import MAX_SEEDS
from qtab.sweeps.connection import store_path
from qtab.sweeps.run_versions import runs_by_versions, versions_note
from qtab.sweeps.store_format import read_store
from qtab.sweeps.study import settings_of

DEFAULT_SEEDS = 100


def add_arguments(parser: Parser) -> None:
    """Adds the arguments of the command."""
    study = (
        "A TOML file: env, seeds, [grid] (or [design] with kind, points, seed and space), [config], block, store, "
        "threads and memory_limit."
    )
    parser.positional("study", study)
    parser.output_flags()
    store = (
        "The SQLite file for the results; by default the one that the study names, or the study's name with suffix .db."
    )
    parser.option("store", Path, store)
    threads = "The number of threads, or of processes for environments stepped in Python; by default one per core."
    parser.option("threads", integer, threads)
    confirm = (
        "Train the best settings again with this many other seeds: their means in the sweep are too high on average."
    )
    parser.option("confirm", integer, confirm)
    parser.option("top", integer, "The number of settings that --confirm trains again; by default 1.")
    per = "Train the best settings of each value of this setting in the grid, such as algorithm, again."
    parser.option("per", str, per)
    confirm_store = "The SQLite file for the results of --confirm, which can then be interrupted and resumed."
    parser.option("confirm_store", Path, confirm_store)


def run(options: Namespace) -> int:
    """Runs the command and returns its exit code."""
    with Report(options) as report:
        report.writes_files = True
        _run(options, report)
    return 0


def _run(options: Namespace, report: Report) -> None:
    with usage_errors():
        if options.threads is not None:
            checks.threads(options.threads)
        study = read_study(options.study)
        store = options.store or options.study.parent / (study.store or options.study.with_suffix(".db").name)
        with _names_file(options.study):
            grid = settings_of(study.grid, study.options.get("memory_limit"))
        _check_confirmation(options, grid, store)
        given = {"seeds": DEFAULT_SEEDS, **study.options}
        if options.threads is not None:
            given["threads"] = options.threads
        try:
            with _names_file(options.study):
                result = sweep(study.env, study.grid, store=store, progress=report.progress, **given, **study.config)
        except KeyboardInterrupt as error:
            kept = counted(len(getattr(error, "run", ())), "run")
            report.text(f"interrupted: kept {kept} in {store}; the same command resumes")
            raise
    runs, settings = counted(len(result), "run"), counted(len(result.settings), "setting")
    report.text(f"{runs} of {settings} in {store}, {result.failed} failed")
    if note := versions_note(result.run_versions):
        report.text(note)
    report.add(**_facts(result), store=store, confirmation=None)
    if options.confirm is not None:
        with usage_errors(), _names_file(options.study):
            confirmation = result.confirm(
                options.confirm,
                top=1 if options.top is None else options.top,
                per=options.per,
                store=options.confirm_store,
                threads=given.get("threads"),
                memory_limit=given.get("memory_limit"),
                progress=report.progress,
            )
            text = str(confirmation)
        report.text(text)
        chosen = zip(confirmation.chosen, confirmation.confirmed.mean_final_returns().tolist(), strict=True)
        report.add(confirmation=[{"setting": setting, "mean_final_return": mean} for setting, mean in chosen])


def _check_confirmation(options: Namespace, settings: Sequence[Mapping[str, Any]], store: Path) -> None:
    """Checks the options of the confirmation before the sweep.

    Raises:
        OSError: if the store of the confirmation cannot be written.
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    if options.confirm is None:
        for name in ("top", "per", "confirm_store"):
            if getattr(options, name) is not None:
                raise ValueError(f"{flag(name)} needs --confirm, the number of seeds")
        return
    checks.integer("--confirm", options.confirm, least=1, most=MAX_SEEDS)
    if options.top is not None:
        checks.integer("--top", options.top, least=1, most=len(settings))
    if options.per is not None:
        checks.choice("--per", options.per, list(settings[0]))
    if options.confirm_store is not None:
        if options.confirm_store.resolve() == store.resolve():
            raise ValueError(f"--confirm-store must be another file than the store of the sweep, {shown(str(store))}")
        path = check_writable("--confirm-store", store_path(options.confirm_store))
        if path.exists() and path.stat().st_size:
            read_store(path)


def _facts(result: Sweep) -> dict[str, Any]:
    """Returns the JSON object of a sweep: its settings, the best first."""
    means = result.mean_final_returns().tolist()
    return {
        "env": result.env,
        "runs": len(result),
        "failed": result.failed,
        "seeds": len(result.seeds),
        "seconds": result.seconds,
        "versions": [{"runs": runs, "versions": one} for one, runs in runs_by_versions(result.run_versions)],
        "ranking": [
            {"setting": setting, "values": result.settings[setting], "mean_final_return": means[setting]}
            for setting in result.ranking()
        ],
    }


@contextmanager
def _names_file(path: Path) -> Iterator[None]:
    """Names the study file in the errors that its content causes."""
    try:
        yield
    except StoreError:
        raise
    except RuntimeError as error:  # a worker process was killed; the message explains how to resume
        raise UsageError(one_line(error)) from error
    except (ValueError, TypeError, OverflowError, MemoryError, gym.error.Error) as error:
        raise UsageError(f"{path}: {one_line(error)}") from error
