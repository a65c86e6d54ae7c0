"""An exercise of a teacher's own is checked like those of qtab."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from qtab.exercises import Exercise, FunctionCheck, check, find


def mean(values: Any, wrong: frozenset[str] = frozenset()) -> float:
    return float(sum(values) / (len(values) - 1 if "n_minus_one" in wrong else len(values)))


def calls() -> Iterator[dict[str, Any]]:
    for count in (3, 5):
        yield {"values": np.arange(1.0, 1.0 + count)}


def exercise(mistakes: Any, model: Any = mean) -> Exercise:
    checks = [FunctionCheck("two means", model, calls, returns=[("mean", 0.0)])]
    return Exercise(13, "mean", "The mean", "2.4", "def mean(values): ...\n", model, mistakes, checks)


WITH_MISTAKE = exercise({"n_minus_one": "divided by n - 1"})


def test_a_mistake_is_explained_in_the_words_of_the_exercise() -> None:
    assert check(WITH_MISTAKE, mean).passed
    report = check(WITH_MISTAKE, lambda values: mean(values, frozenset({"n_minus_one"})))
    assert report.mistakes == ("divided by n - 1",)
    assert "mean: yours 3, reference 2" in str(report)
    assert str(report).startswith("exercise 13, mean: its check failed\n")


def test_a_model_without_mistakes_needs_no_parameter_for_them() -> None:
    plain = exercise((), lambda values: mean(values))
    report = check(plain, lambda values: 0.0)
    assert not report.passed
    assert report.mistakes == ()
    assert check(plain, mean).passed


def test_a_value_of_another_type_is_refused() -> None:
    report = check(WITH_MISTAKE, lambda values: None)
    assert "call 0: mean must be a number, got None" in str(report)


def test_an_exercise_is_found_in_its_module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "week_three.py").write_text("from qtab.exercises import find\n\nSARSA = find('sarsa')\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    assert find("week_three:SARSA") is find("sarsa")
    with pytest.raises(ValueError, match=r"did you mean 'SARSA'\?\): its exercises are SARSA"):
        find("week_three:SARS")
    with pytest.raises(ValueError, match="it defines no exercise"):
        find("json:SARSA")
    for name in (":SARSA", ".week_three:SARSA"):
        with pytest.raises(ValueError, match=f"exercise must be module:NAME, got '{name}'"):
            find(name)
    with pytest.raises(ImportError, match="week_four"):
        find("week_four:SARSA")
    sys.modules.pop("week_three")
