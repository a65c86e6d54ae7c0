"""Prints what the tests need, for pip: the lowest versions that a wheel declares, or its requirements as they are.

    python .ci/requirements.py WHEEL lowest|newest

It runs in the environment for which it prints them, whose pip brings the parser.
"""

import sys
import zipfile
from email.parser import Parser
from pathlib import Path

from pip._vendor.packaging.requirements import Requirement
from pip._vendor.packaging.specifiers import SpecifierSet
from pip._vendor.packaging.version import Version

EXTRAS = ("", "all", "plot", "video", "cli", "stats", "cluster", "test")
NOT_RUN = {"mypy", "pyright", "qtab"}
"""What checks types, which `.ci/run lint` does; and the extras that the wheel puts together."""


def main(wheel: Path, versions: str) -> None:
    """Prints a requirement on each line."""
    with zipfile.ZipFile(wheel) as archive:
        (name,) = (name for name in archive.namelist() if name.endswith(".dist-info/METADATA"))
        metadata = Parser().parsestr(archive.read(name).decode())
    found = set()
    for text in metadata.get_all("Requires-Dist", []):
        requirement = Requirement(text)
        if requirement.name in NOT_RUN or not any(applies(requirement, extra) for extra in EXTRAS):
            continue
        requirement.marker = None
        lowest = [specifier.version for specifier in requirement.specifier if specifier.operator == ">="]
        if versions == "lowest" and lowest:
            requirement.specifier = SpecifierSet(f"=={max(lowest, key=Version)}")
        found.add(str(requirement))
    print("\n".join(sorted(found)))


def applies(requirement: Requirement, extra: str) -> bool:
    """Returns whether a requirement belongs to an extra on this machine."""
    return requirement.marker is None or requirement.marker.evaluate({"extra": extra})


main(Path(sys.argv[1]), sys.argv[2])
