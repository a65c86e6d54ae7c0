"""Writes the version that a tag names into the files that hold it: the tag is where a version is decided.

    python .ci/version.py v1.2.3

The tag is vMAJOR.MINOR.PATCH, or for a release candidate vMAJOR.MINOR.PATCH-rc.N. The changelog must have a section of
that release, with its date unless it is a candidate.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
TAG = re.compile(r"v((\d+\.\d+\.\d+)(-rc\.\d+)?)", re.ASCII)


def main(tag: str) -> None:
    """Writes the version of a tag, and prints what was changed."""
    matched = TAG.fullmatch(tag)
    if not matched:
        sys.exit(f"the tag must be like v1.2.3 or v1.2.3-rc.1, got {tag!r}")
    version, release, candidate = matched.groups()
    heading = rf"^## \[{re.escape(release)}\] - " + (
        r"(\d{4}-\d\d-\d\d|unreleased)$" if candidate else r"\d{4}-\d\d-\d\d$"
    )
    if not re.search(heading, (ROOT / "CHANGELOG.md").read_text(encoding="utf-8"), re.MULTILINE):
        sys.exit(f"CHANGELOG.md needs a heading '## [{release}] - YYYY-MM-DD'")
    old = re.search(r'^version = "(.+)"', (ROOT / "Cargo.toml").read_text(encoding="utf-8"), re.MULTILINE)
    if old is None:
        sys.exit("Cargo.toml has no version")
    packages = "|".join(re.findall(r'^name = "(qtab-[a-z]+)"\nversion = ', lock_text(), re.MULTILINE))
    replace("Cargo.toml", rf'^(version = ")()({re.escape(old.group(1))})(")', version)
    replace("Cargo.toml", rf'^(qtab-core = .*version = ")()({re.escape(old.group(1))})(")', version)
    replace("Cargo.lock", rf'^(name = "({packages})"\nversion = ")(.+)(")', version)
    replace("CITATION.cff", r"^(version: )()(.+)()$", version)
    print(f"version {old.group(1)} -> {version}")


def lock_text() -> str:
    """Returns the contents of Cargo.lock."""
    return (ROOT / "Cargo.lock").read_text(encoding="utf-8")


def replace(name: str, pattern: str, version: str) -> None:
    """Replaces the third group of every match in a file."""
    path = ROOT / name
    text, count = re.subn(
        pattern, lambda match: match[1] + version + match[4], path.read_text(encoding="utf-8"), flags=re.MULTILINE
    )
    if count == 0:
        sys.exit(f"{name} has no version to replace")
    path.write_text(text, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main(sys.argv[1])
