"""The HTML page of a report."""

from collections.abc import Mapping, Sequence
from typing import Any

from qtab._utils.page import page as html_page
from qtab._utils.page import paragraph, picture, section, table
from qtab.sweeps.report_plots import MAX_SETTINGS, Picture
from qtab.sweeps.results import Sweep
from qtab.sweeps.run_versions import by_name, in_words, versions_note


def page(
    sweep: Sweep,
    header: Sequence[str],
    rows: Sequence[Sequence[Any]],
    pictures: Mapping[str, Picture],
    command: str | None,
) -> str:
    """Returns the page, which needs no other file.

    Args:
        sweep: The sweep.
        header: The header of the table of settings.
        rows: Its rows, best first.
        pictures: The pictures by name.
        command: The command that writes the report, or None.
    """
    parts = [*map(paragraph, _notes(sweep, len(rows))), table(header, rows)]
    parts += [
        section(name.replace("_", " ", 1).capitalize(), picture(drawn.png, drawn.alternative))
        for name, drawn in pictures.items()
    ]
    parts.append(section("Settings that all runs share", table(("setting", "value"), _shared(sweep))))
    parts.append(section("How it was made", table((), _origin(sweep, command))))
    return html_page(sweep.env, "\n".join(parts))


def _notes(sweep: Sweep, ranked: int) -> list[str]:
    total = len(sweep.settings) * len(sweep.seeds)
    runs = f"{len(sweep):,} runs" if len(sweep) == total else f"{len(sweep):,} of {total:,} runs"
    notes = [
        f"{runs}: {len(sweep.settings)} settings, {len(sweep.seeds)} seeds each, {sweep.failed} failed. Final returns "
        "are means of the last 100 episodes; the interval of the mean has a coverage of 95%."
    ]
    if sweep.failed:
        notes.append(
            "The order is that of ranked_mean, in which a failed run counts as the worst run of the sweep. The other "
            "statistics leave failed runs out."
        )
    if ranked > 1:
        notes.append(
            f"The best of {ranked} settings looks better than it is, because the choice prefers lucky seeds. Train it "
            "again with other seeds: sweep.confirm(seeds=100) in Python, or qtab sweep with --confirm 100."
        )
    if ranked > MAX_SETTINGS:
        notes.append(f"The pictures show the best {MAX_SETTINGS} of {ranked} settings; the table has all of them.")
    if note := versions_note(sweep.run_versions):
        notes.append(note)
    return notes


def _shared(sweep: Sweep) -> list[tuple[str, Any]]:
    """Returns the settings that are given and the same for all runs."""
    first = sweep.configs[0]
    return [
        (name, value)
        for name, value in sorted(first.items())
        if value not in (None, [], {}) and all(config.get(name) == value for config in sweep.configs)
    ]


def _origin(sweep: Sweep, command: str | None) -> list[tuple[str, Any]]:
    rows: list[tuple[str, Any]] = [] if command is None else [("command", command)]
    rows += [("seeds", _seeds(sweep.seeds)), ("block", f"{sweep.block} episodes")]
    rows.append(("training", f"{sweep.seconds:.1f} s, summed over the processes that took part"))
    known = len(sweep) - list(sweep.run_versions).count(None)
    for name, values in by_name(sweep.run_versions).items():
        is_of_all = len(values) == 1 and known == len(sweep)
        rows.append((name, values[0][0] if is_of_all else in_words(values)))
    return rows if known else [*rows, ("versions", "unknown")]


def _seeds(seeds: Sequence[int]) -> str:
    if list(seeds) == list(range(seeds[0], seeds[0] + len(seeds))) and len(seeds) > 2:
        return f"{seeds[0]} to {seeds[-1]}"
    return ", ".join(map(str, seeds[:20])) + (", ..." if len(seeds) > 20 else "")
