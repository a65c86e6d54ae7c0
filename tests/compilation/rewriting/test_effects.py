"""Calls that change the state are never left out, moved or made conditional without a word."""

import inspect
from typing import Any

import pytest

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting import rewrite
from support.environments.gym_classes import left_out
from support.environments.marked import marked_line
from support.lockstep.rewriting import assert_equal_steps

REFUSED = [
    value
    for value in vars(left_out).values()
    if isinstance(value, type) and issubclass(value, left_out.Moves) and "# here" in inspect.getsource(value)
]


@pytest.mark.parametrize("cls", REFUSED, ids=lambda cls: cls.__name__)
def test_a_call_whose_result_is_left_out_is_refused(cls: Any) -> None:
    with pytest.raises(NotCompilable, match="a call ") as caught:
        rewrite(cls())
    assert caught.value.line == marked_line(cls)
    assert caught.value.advice == "assign it to a variable first"


@pytest.mark.parametrize(
    "cls", [left_out.Assigned, left_out.ShortCircuits, left_out.KeepsInDict], ids=lambda cls: cls.__name__
)
def test_calls_that_are_all_evaluated_compute_what_the_class_computes(cls: Any) -> None:
    assert_equal_steps(cls(), rewrite(cls()), 200, 3)
