"""The environments on the page about libraries are built, and both learn the same."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import qtab
from support.documents.pages import blocks
from support.native.libraries import build_rust, compile_c, needs_cargo, needs_compiler
from support.repository import ROOT

PAGE = ROOT / "docs" / "how_to" / "native_libraries.md"
MANIFEST = f"""
[package]
name = "walk"
version = "0.1.0"
edition = "2024"

[lib]
crate-type = ["cdylib"]

[dependencies]
qtab-env = {{ path = "{(ROOT / "rust" / "env").as_posix()}" }}

[workspace]
"""


def page_blocks(language: str) -> list[str]:
    return [found.code for found in blocks(PAGE.read_text(encoding="utf-8"), language)]


def in_c(folder: Path) -> Path:
    return compile_c(page_blocks("c")[0], folder, "walk", "-Wno-unused-parameter")


@needs_compiler
def test_the_environment_in_c_learns(tmp_path: Path) -> None:
    run = qtab.train(qtab.NativeEnv(in_c(tmp_path)), episodes=300, seed=0)
    assert run.config.backend == "rust"
    assert run.policy[1:6].tolist() == [1] * 5


@needs_compiler
@pytest.mark.parametrize("count", [2, 3, 5])
def test_the_integers_in_c_are_those_of_numpy(tmp_path: Path, count: int) -> None:
    walk, integers = page_blocks("c")
    drawn = walk.replace("state = 3;", f"state = 1 + integer_below(rng, {count});")
    with_integers = drawn.replace('"qtab_env.h"\n', f'"qtab_env.h"\n{integers}\n')
    env = qtab.NativeEnv(compile_c(with_integers, tmp_path, "integers", "-Wno-unused-parameter"))
    ours = [env.reset(seed=1)[0], *(env.reset()[0] for _ in range(500))]
    generator = np.random.default_rng(1)
    assert ours == [1 + int(generator.integers(0, count)) for _ in ours]


@needs_compiler
@needs_cargo
@pytest.mark.slow
def test_the_environment_in_rust_is_the_same(tmp_path: Path) -> None:
    (tmp_path / "src").mkdir()
    (tmp_path / "src" / "lib.rs").write_text(page_blocks("rust")[0], encoding="utf-8")
    (tmp_path / "Cargo.toml").write_text(MANIFEST, encoding="utf-8")
    libraries = in_c(tmp_path), build_rust(tmp_path, tmp_path / "target", "walk")
    settings: dict[str, Any] = {"episodes": 100, "max_episode_steps": 100, "seed": 0}
    one, other = (qtab.train(qtab.NativeEnv(library), **settings) for library in libraries)
    assert one.tables.tobytes() == other.tables.tobytes()
    assert one.episode_returns.tobytes() == other.episode_returns.tobytes()
