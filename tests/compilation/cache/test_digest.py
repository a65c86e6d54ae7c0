"""The digest covers values of nested modules and long arrays, and none that is only named like an attribute."""

import logging
import math
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from qtab.compilation.cache.digest import digest_of

pytest.importorskip("numba")

outer: Any = ModuleType("outer")
settings: Any = ModuleType("outer.settings")
outer.settings, settings.outer, settings.SLIP = settings, outer, 0.1
log = logging.getLogger(__name__)
records = np.zeros(2000, [("wind", np.float64), ("cell", np.int64)])


def nested() -> Any:
    return outer.settings.SLIP


def logarithm() -> float:
    return math.log(2.0)


def logs() -> None:
    log.info("a step")


def waits() -> Any:
    log.info("a step")
    return outer.settings.SLIP


def first_wind() -> Any:
    return records[0]["wind"]


def _digest(function: Any) -> str:
    return digest_of({"f": function}, []).text


def test_values_of_nested_modules(monkeypatch: pytest.MonkeyPatch) -> None:
    before = _digest(nested)
    assert _digest(nested) == before
    monkeypatch.setattr(settings, "SLIP", 0.5)
    assert _digest(nested) != before


def test_a_global_with_the_name_of_an_attribute_is_not_used() -> None:
    for function, unknown in ((logarithm, ()), (logs, (log,))):
        used: Any = function
        assert digest_of({"f": used}, []).unknown == unknown


def test_values_beside_one_without_a_digest(monkeypatch: pytest.MonkeyPatch) -> None:
    before = _digest(waits)
    monkeypatch.setattr(settings, "SLIP", 0.5)
    assert _digest(waits) != before


def test_long_arrays_of_records(monkeypatch: pytest.MonkeyPatch) -> None:
    before = _digest(first_wind)
    changed = records.copy()
    changed["wind"][700] = 1.0
    monkeypatch.setattr(f"{__name__}.records", changed)
    assert _digest(first_wind) != before
