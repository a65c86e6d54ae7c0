"""All experiments of the book in a folder: the table, the points and the picture of each."""

import hashlib
import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from qtab._utils import checks
from qtab._utils.files import replacing
from qtab._utils.versions import versions
from qtab.book.experiment import Experiment
from qtab.book.registry import EXPERIMENTS

SUFFIXES = (".txt", ".csv", ".png")
"""The files of an experiment: its table, its points, and its picture."""
SOURCES = Path(__file__).parent
"""The folder with the code of the experiments."""
RECORD = "book.json"
"""The file that records how each experiment was run; one that was run with other arguments is run again."""


def run_all(
    folder: "str | os.PathLike[str]",
    runs: int | None = None,
    seed: int = 0,
    *,
    threads: int | None = None,
    progress: bool | None = None,
    on_start: Callable[[Experiment, bool], None] | None = None,
) -> None:
    """Runs every experiment of the book and writes its table, its points and its picture to a folder.

    Skips experiments whose files exist already, from a call with the same ``runs`` and ``seed``, the same versions and
    the same code of the experiments: if interrupted, call it again and it resumes.

    Args:
        folder: The folder, which is created if it does not exist.
        runs: The number of runs of each setting; None means that of the full figure.
        seed: The seed of the first run of each setting.
        threads: The number of threads; None means one per core. It does not change the results.
        progress: Whether to show a progress bar for each experiment; None shows one on a terminal if it takes longer
            than a second.
        on_start: Called before each experiment with the experiment, and whether it is skipped because its files exist.

    Raises:
        KeyboardInterrupt: on Ctrl-C; the files that were written stay.
        ModuleNotFoundError: without matplotlib; the message names the ``pip install``.
        OSError: if a file cannot be written.
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """
    from qtab.book.drawing import save_plot

    target = checks.path("folder", folder)
    for experiment in EXPERIMENTS.values():
        experiment.check_arguments(runs, seed, threads)
    target.mkdir(parents=True, exist_ok=True)
    record = _read(target / RECORD)
    how = {"runs": runs, "seed": seed, "versions": versions(), "code": _code()}
    for name, experiment in EXPERIMENTS.items():
        files = [target / f"{name}{suffix}" for suffix in SUFFIXES]
        done = record.get(name) == how and all(file.exists() for file in files)
        if on_start is not None:
            on_start(experiment, done)
        if done:
            continue
        result = experiment.run(runs, seed, threads=threads, progress=progress)
        table, points, picture = files
        with replacing(table) as temporary:
            temporary.write_text(f"{result}\n", encoding="utf-8")
        result.save(points)
        save_plot(result, picture)
        record[name] = how
        with replacing(target / RECORD) as temporary:
            temporary.write_text(json.dumps(record, indent=2) + "\n", encoding="utf-8")


def _code() -> str:
    """Returns a fingerprint of the code of all experiments, which can change while the version stays the same."""
    digest = hashlib.sha256()
    for path in sorted(SOURCES.rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()


def _read(path: Path) -> dict[str, Any]:
    """Returns the record, or an empty one if there is none that can be read."""
    try:
        record = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return record if isinstance(record, dict) else {}
