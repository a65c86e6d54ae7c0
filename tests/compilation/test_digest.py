"""The digest covers the values of nested modules, and no values that are only named like an attribute."""

import logging
import math
from types import ModuleType
from typing import Any

import pytest

from qtab.compilation.digest import Unknown, digest_of

pytest.importorskip("numba")

outer: Any = ModuleType("outer")
settings: Any = ModuleType("outer.settings")
outer.settings, settings.outer, settings.SLIP = settings, outer, 0.1
log = logging.getLogger(__name__)


def nested() -> Any:
    return outer.settings.SLIP


def logarithm() -> float:
    return math.log(2.0)


def logs() -> None:
    log.info("a step")


def _digest(function: Any) -> str:
    return digest_of({"f": function}, [])


def test_values_of_nested_modules(monkeypatch: pytest.MonkeyPatch) -> None:
    before = _digest(nested)
    assert _digest(nested) == before
    monkeypatch.setattr(settings, "SLIP", 0.5)
    assert _digest(nested) != before


def test_a_global_with_the_name_of_an_attribute_is_not_used() -> None:
    assert _digest(logarithm)
    with pytest.raises(Unknown):
        _digest(logs)
