"""The ``qtab`` command."""


def main() -> int:
    """Runs the command line."""
    return 0
