"""The digest covers the values of nested modules, and no values that are only named like an attribute."""

import logging
import math
from types import ModuleType

import pytest

from qtab.compilation.digest import Unknown, digest_of

pytest.importorskip("numba")

outer, settings = ModuleType("outer"), ModuleType("outer.settings")
outer.settings, settings.outer, settings.SLIP = settings, outer, 0.1  # type: ignore[attr-defined]
log = logging.getLogger(__name__)


def nested() -> float:
    return outer.settings.SLIP  # type: ignore[no-any-return]


def logarithm() -> float:
    return math.log(2.0)


def logs() -> None:
    log.info("a step")


def test_values_of_nested_modules(monkeypatch: pytest.MonkeyPatch) -> None:
    before = digest_of({"f": nested}, [])
    assert digest_of({"f": nested}, []) == before
    monkeypatch.setattr(settings, "SLIP", 0.5)
    assert digest_of({"f": nested}, []) != before


def test_a_global_with_the_name_of_an_attribute_is_not_used() -> None:
    assert digest_of({"f": logarithm}, [])
    with pytest.raises(Unknown):
        digest_of({"f": logs}, [])
