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

NOT_RUN = {"mypy", "pyright"}
"""What checks types, which `.ci/run lint` does."""


def main(wheel: Path, versions: str) -> None:
    """Prints a requirement on each line."""
    with zipfile.ZipFile(wheel) as archive:
        (name,) = (name for name in archive.namelist() if name.endswith(".dist-info/METADATA"))
        metadata = Parser().parsestr(archive.read(name).decode())
    declared = [Requirement(text) for text in metadata.get_all("Requires-Dist", [])]
    found = set()
    for requirement in required(declared, metadata["Name"], "test"):
        if requirement.name in NOT_RUN:
            continue
        requirement.marker = None
        lowest = [specifier.version for specifier in requirement.specifier if specifier.operator == ">="]
        if versions == "lowest" and lowest:
            requirement.specifier = SpecifierSet(f"=={max(lowest, key=Version)}")
        found.add(str(requirement))
    print("\n".join(sorted(found)))


def required(declared: list[Requirement], package: str, *extras: str) -> list[Requirement]:
    """Returns what a package needs on this machine with some extras, and with the extras that these name in turn."""
    pending, seen, found = ["", *extras], set(), []
    while pending:
        extra = pending.pop()
        seen.add(extra)
        for requirement in declared:
            if not (requirement.marker is None or requirement.marker.evaluate({"extra": extra})):
                continue
            if requirement.name == package:
                pending.extend(requirement.extras - seen)
            else:
                found.append(requirement)
    return found


main(Path(sys.argv[1]), sys.argv[2])
