"""Libraries that cannot be used: each is refused with the reason."""

from pathlib import Path
from typing import Any

import pytest

import qtab
from support.native.board import board_library
from support.native.libraries import compile_c, needs_compiler

pytestmark = needs_compiler
FLOATS = {"TYPE": "QTAB_FLOAT64", "NUMBER": "double"}


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"VERSION": 2}, "its version of qtab_env.h must be 1, got 2"),
        ({"STRUCT_SIZE": 8}, "its struct_size must be 96, sizeof(qtab_env), got 8"),
        ({"ACTIONS": 0}, "its num_actions must be from 1 to 2147483647, got 0"),
        (
            {"TYPE": 7, "NUMBER": "double"},
            "its observation_type must be QTAB_FLOAT32, QTAB_FLOAT64 or QTAB_INT64, got 7",
        ),
        ({"UNBOUNDED": True}, "its observation_low must be an integer for QTAB_INT64, got "),
        ({"RETURNS_NULL": True}, "qtab_env_1() returned NULL"),
        ({"NO_SYMBOL": True}, "must export the function qtab_env_1() of qtab_env.h, but has none"),
        ({"RESET_FAILS": True}, "a function returned QTAB_FAILED"),
        ({"FAILS_AT": 3}, "a function returned QTAB_FAILED"),
        ({"NAN_REWARD": True}, "step must write a finite number as the reward, got NaN"),
        ({"CODE": 9}, "step must return a sum of QTAB_TERMINATED and QTAB_TRUNCATED, or QTAB_FAILED, got 9"),
        ({"BAD_OBSERVATION": 6}, "got 6 as observation[1], which has the bounds 3 and 5"),
        ({"BAD_OBSERVATION": "NAN", **FLOATS}, "got NaN as observation[1], which has the bounds 3 and 5"),
        ({"BAD_OBSERVATION": "-INFINITY", "UNBOUNDED": True, **FLOATS}, "got -inf as observation[1]"),
        ({"CRASHES": True}, "it crashed in a trial of 100 steps (SIG"),
        ({"BEYOND": True}, "a function wrote beyond the end of observation"),
        ({"NO_ACTION": 2}, "step must write an action mask of 0 and 1 with at least one 1, got [0, 0, 0]"),
    ],
    ids=str,
)
def test_a_library_that_breaks_a_rule(tmp_path: Path, options: dict[str, Any], message: str) -> None:
    library = board_library(tmp_path, **options)
    with pytest.raises(ValueError) as raised:
        qtab.NativeEnv(library)
    assert str(raised.value).startswith(str(library))
    assert message in str(raised.value)


def test_a_file_that_is_missing(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match="path must be that of a shared library, but there is no file"):
        qtab.NativeEnv(tmp_path / "libmissing.so")


def test_a_file_that_is_no_library(tmp_path: Path) -> None:
    file = tmp_path / "libtext.so"
    file.write_text("text", encoding="utf-8")
    with pytest.raises(ValueError, match="must be a shared library that this machine can load"):
        qtab.NativeEnv(file)


def test_a_library_that_is_compiled_again_is_loaded_again(tmp_path: Path) -> None:
    one = qtab.NativeEnv(board_library(tmp_path))
    other = qtab.NativeEnv(board_library(tmp_path, TYPE="QTAB_FLOAT64", NUMBER="double"))
    assert one.observation_space != other.observation_space
    for env in (one, other):
        observation, _ = env.reset(seed=0)
        assert observation in env.observation_space


def test_the_header_compiles_as_strict_c_and_as_cpp(tmp_path: Path) -> None:
    source = (
        '#include "qtab_env.h"\nconst qtab_env *qtab_env_1(void);\nint unused(void);\nint unused(void) { return 0; }\n'
    )
    compile_c(source, tmp_path, "strict", "-std=c99", "-pedantic-errors")
    compile_c(source, tmp_path, "other", "-x", "c++", "-std=c++11", "-pedantic-errors")
