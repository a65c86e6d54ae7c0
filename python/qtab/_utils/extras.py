"""Optional libraries: where one is missing, the error names the ``pip install`` that brings it."""


def missing(error: ModuleNotFoundError, extra: str) -> ModuleNotFoundError:
    """Returns the error to raise where a library of an extra is not installed."""
    return ModuleNotFoundError(
        f"this needs {error.name}, which is not installed; run: pip install 'qtab[{extra}]'", name=error.name
    )
