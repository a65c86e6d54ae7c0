"""Optional libraries: the error if one is not installed, with the command that installs it."""

import re
import sys

_PYTHON_BELOW = re.compile(r"python(?:_full)?_version < '(\d+)\.(\d+)'")
"""The only condition of requirements of extras, apart from the name of the extra."""


def missing(error: ModuleNotFoundError, extra: str | None = None) -> ModuleNotFoundError:
    """Returns the error to raise instead of the import error of an optional library.

    Its message names a ``pip install`` of the libraries themselves, which works wherever qtab was installed from.

    Args:
        error: The error of the import.
        extra: The extra of this package that lists the library; None if none does.
    """
    requirements = _requirements(extra) or [str(error.name)]
    command = " ".join(["pip install", *requirements])
    return ModuleNotFoundError(f"this needs {error.name}, which is not installed; run: {command}", name=error.name)


def _requirements(extra: str | None) -> list[str]:
    """Returns the requirements of an extra for this version of Python, quoted for a shell."""
    from importlib.metadata import PackageNotFoundError, requires  # takes as long to load as all of qtab's own modules

    try:
        declared = requires("qtab") or []
    except PackageNotFoundError:
        return []
    names = []
    for requirement in declared:
        name, _, marker = requirement.partition(";")
        conditions = marker.replace('"', "'").replace("(", "").replace(")", "").split(" and ")
        parts = {" ".join(condition.split()) for condition in conditions}
        below = _PYTHON_BELOW.search(" ".join(parts))
        applies = below is None or sys.version_info < (int(below[1]), int(below[2]))
        if f"extra == '{extra}'" in parts and applies:
            names.append(f"'{name.strip()}'")
    return names
