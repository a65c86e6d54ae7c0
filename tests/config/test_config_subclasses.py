"""Subclasses of Config are checked as Config is."""

from dataclasses import dataclass

import pytest

import qtab
from qtab.config import DEFAULTS


@dataclass(frozen=True, eq=False)
class Annotated(qtab.Config):
    note: str = ""


def test_a_dataclass_derived_from_config_checks_its_settings() -> None:
    assert Annotated(learning_rate=0.5, note="half").note == "half"
    with pytest.raises(TypeError, match="learning_rate must be a finite number, got 'a'"):
        Annotated(learning_rate="a")  # type: ignore[arg-type]


def test_a_config_has_arguments_of_the_environment_of_its_own() -> None:
    assert qtab.Config(**DEFAULTS).env_kwargs is not DEFAULTS["env_kwargs"]
