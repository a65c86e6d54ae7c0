"""The experiments there are, and how one is found by its number."""

from collections.abc import Mapping

from qtab.book.experiment import Experiment, Result
from qtab.book.figures import (
    example_6_5,
    example_6_6,
    figure_6_3,
    figure_6_5,
    figure_8_2,
    figure_10_1,
    figure_10_2,
    figure_10_3,
    figure_10_4,
    figure_12_10,
    figure_12_11,
)

EXPERIMENTS: Mapping[str, Experiment] = {
    module.EXPERIMENT.name: module.EXPERIMENT
    for module in (
        example_6_5,
        example_6_6,
        figure_6_3,
        figure_6_5,
        figure_8_2,
        figure_10_1,
        figure_10_2,
        figure_10_3,
        figure_10_4,
        figure_12_10,
        figure_12_11,
    )
}
"""By their names, in the book's order."""


def find(name: str) -> Experiment:
    """Returns an experiment by its name ("figure-10.4"), or by its number ("10.4") where only one has it.

    Raises:
        TypeError: if the name is no string.
        ValueError: if there is none, or more than one; it lists them.
    """
    if not isinstance(name, str):
        raise TypeError(f"name must be one of {', '.join(EXPERIMENTS)}, got {name!r}")
    wanted = name.strip().lower().replace(" ", "-")
    if wanted in EXPERIMENTS:
        return EXPERIMENTS[wanted]
    found = [experiment for experiment in EXPERIMENTS.values() if experiment.number == wanted]
    if len(found) > 1:
        raise ValueError(f"name must be {' or '.join(one.name for one in found)}, got {name!r}, which is both")
    if not found:
        raise ValueError(f"name must be one of {', '.join(EXPERIMENTS)}, got {name!r}")
    return found[0]


def run(
    name: str, runs: int | None = None, seed: int = 0, *, threads: int | None = None, progress: bool | None = None
) -> Result:
    """Runs an experiment of the book.

    Args:
        name: Its name ("figure-10.4"), or its number ("10.4") where only one has it.
        runs: How many runs of each setting; None means as many as in the book.
        seed: The seed of each setting's first run; the others follow it.
        threads: How many threads; None means one a core. The numbers do not depend on it.
        progress: Whether to show a progress bar; None shows one on a terminal, to what takes more than a second.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range, or an experiment that there is not.
        KeyboardInterrupt: on Ctrl-C.
    """
    return find(name).run(runs, seed, threads=threads, progress=progress)
