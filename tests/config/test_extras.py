"""The advice where an optional library is missing installs all that its extra needs on this version of Python."""

import importlib.metadata
import sys

import pytest

from qtab._utils import extras

DECLARED = [
    "gymnasium>=1.4",
    "rich>=1.0 ; extra == 'cli'",
    'tqdm>=4.66; extra == "cli"',
    "tomli>=2.0 ; python_full_version < '3.11' and extra == 'cli'",
    "typing-extensions>=4; (python_version < '3.11') and extra == 'cli'",
    "scipy>=1.15 ; extra == 'stats'",
]


@pytest.mark.parametrize(("version", "brings"), [((3, 10, 13), True), ((3, 11, 0), False), ((3, 14, 0), False)])
def test_the_advice_depends_on_the_version_of_python(monkeypatch, version, brings):
    monkeypatch.setattr("importlib.metadata.requires", lambda name: DECLARED)
    monkeypatch.setattr(sys, "version_info", version)
    error = extras.missing(ModuleNotFoundError("No module named 'tomli'", name="tomli"), "cli")
    old = " 'tomli>=2.0' 'typing-extensions>=4'" if brings else ""
    assert str(error) == f"this needs tomli, which is not installed; run: pip install 'rich>=1.0' 'tqdm>=4.66'{old}"
    assert error.name == "tomli"


def test_a_package_without_metadata_names_the_library(monkeypatch):
    def unknown(name):
        raise importlib.metadata.PackageNotFoundError(name)

    monkeypatch.setattr("importlib.metadata.requires", unknown)
    error = extras.missing(ModuleNotFoundError("No module named 'scipy'", name="scipy"), "stats")
    assert str(error) == "this needs scipy, which is not installed; run: pip install scipy"
