"""Optional libraries: the error where one is not installed, with the command that installs it."""

from importlib.metadata import PackageNotFoundError, requires


def missing(error: ModuleNotFoundError, extra: str | None = None) -> ModuleNotFoundError:
    """Returns the error to raise in place of one for an optional library.

    Its message names a ``pip install`` of the libraries themselves, which helps wherever qtab was installed from.

    Args:
        error: The error of the import.
        extra: The extra of this package that lists the library; None if none does.
    """
    requirements = _requirements(extra) or [str(error.name)]
    command = " ".join(["pip install", *requirements])
    return ModuleNotFoundError(f"this needs {error.name}, which is not installed; run: {command}", name=error.name)


def _requirements(extra: str | None) -> list[str]:
    """Returns the requirements of an extra, quoted for a shell."""
    try:
        declared = requires("qtab") or []
    except PackageNotFoundError:
        return []
    names = []
    for requirement in declared:
        name, _, marker = requirement.partition(";")
        if marker.strip().replace('"', "'") == f"extra == '{extra}'":
            names.append(f"'{name.strip()}'")
    return names
