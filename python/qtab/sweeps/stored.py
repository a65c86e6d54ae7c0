"""What a store holds, read without writing to it."""

import logging
import os
from contextlib import suppress
from pathlib import Path
from typing import Any

from qtab._utils.versions import versions
from qtab.sweeps.connection import StoreError, is_writable, name_of, reading
from qtab.sweeps.database import Contents, is_empty, read_contents
from qtab.sweeps.description import Description
from qtab.sweeps.environments import check_environments
from qtab.sweeps.run_versions import UNKNOWN, named_versions, versions_note, versions_of_runs

_LOGGER = logging.getLogger("qtab")


def store_path(path: Any) -> Path:
    """Returns the argument ``store`` as a path.

    Raises:
        OSError: if it names something that is not a regular file.
        TypeError: if it is not a path.
        ValueError: if it names no file.
    """
    if not isinstance(path, str | os.PathLike):
        raise TypeError(f"store must be a path or None, got {path!r}")
    text = os.fspath(path)
    if not isinstance(text, str):
        raise TypeError(f"store must be a path or None, got {path!r}")
    if text in ("", ":memory:") or text.startswith("file:") or "\0" in text:
        raise ValueError(f"store must be the path of a file, got {text!r}; None keeps the results in memory")
    found = Path(text)
    if found.is_dir():
        raise IsADirectoryError(f"store must be a file, got the folder {text!r}")
    if found.exists() and not found.is_file():
        raise OSError(f"store must be a regular file, got {text!r}")
    return found


def finished_contents(path: Path, description: Description) -> Contents | None:
    """Returns what a finished store on a read-only medium holds; None if it can be written, or does not exist.

    Raises:
        OSError: if the store is not finished.
        StoreError: if it is damaged, or belongs to another study.
    """
    if not path.exists() or is_writable(path):
        return None
    contents = read_store(path)
    check_study(contents, description, path)
    warn_unknown(contents, path)
    if len(contents.runs) < description.runs:
        raise PermissionError(
            f"{name_of(path)} cannot be written, and has only {len(contents.runs):,} of {description.runs:,} runs"
        )
    return contents


def read_store(path: Path) -> Contents:
    """Returns what a store holds, which may belong to a sweep that is still running.

    Raises:
        OSError: if the file cannot be read.
        StoreError: if it is not a store, is damaged, or is empty.
    """
    with reading(path) as connection:
        connection.execute("BEGIN")
        if is_empty(connection):
            raise StoreError(f"{name_of(path)} is empty: its sweep ended before it stored anything; start it again")
        contents = read_contents(connection, path)
        warn_versions(contents, path)
        return contents


def check_study(contents: Contents, description: Description, path: Path | None) -> None:
    """Checks that a store belongs to a study, or to the same one with fewer seeds.

    Raises:
        StoreError: if it does not.
    """
    stored = contents.description
    if stored.text == description.text or description.has_more_seeds(stored):
        if description.environments is not None:
            check_environments(contents.meta.get("environments"), description.environments, path)
        return
    if stored.has_more_seeds(description):
        raise StoreError(
            f"{name_of(path)} has runs of {len(stored.seeds)} seeds, of which this sweep has only "
            f"{len(description.seeds)}; give it all of them, or choose another file"
        )
    raise StoreError(
        f"{name_of(path)} belongs to another sweep (other settings, seeds or environment); choose another file"
    )


def warn_unknown(contents: Contents, path: Path | None) -> None:
    """Logs which information a store lacks, and that its results come from other versions than these."""
    if "environments" not in contents.meta:
        _LOGGER.warning(
            "%s stores only the id and the arguments of its environment, like all stores of earlier versions: the "
            "rest of it is not compared",
            name_of(path),
        )
    here = versions()
    others = [
        f"{name} {one.get(name)}"
        for one in _versions_before(contents)
        if isinstance(one, dict) and one
        for name in here
        if one.get(name) != here[name]
    ]
    if others and contents.runs:
        _LOGGER.warning(
            "%s has results made with %s, which these may differ from", name_of(path), ", ".join(dict.fromkeys(others))
        )


def _versions_before(contents: Contents) -> list[Any]:
    """The different versions of the runs of a store; where these are not known, those that the store names."""
    if UNKNOWN not in contents.places:
        return versions_of_runs(contents.meta, sorted(set(contents.places)))
    with suppress(ValueError):
        return named_versions(contents.meta)
    return []


def warn_versions(contents: Contents, path: Path | None) -> None:
    """Logs if runs were trained with different versions, or with unknown ones."""
    if note := versions_note(versions_of_runs(contents.meta, contents.places)):
        _LOGGER.warning("%s: %s", name_of(path), note)
