"""The build of the WebAssembly module: where it is looked for, with which flags, and whether it is of these sources."""

import importlib
import json
import os
import shutil
import subprocess
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from support.repository import ROOT

FOLDER = ROOT / "rust/web"
pytestmark = pytest.mark.skipif(not FOLDER.exists(), reason="needs the sources of the WebAssembly module")

HEADER = b"\0asm\1\0\0\0"
# Exports a function `call` and a memory `memory`, as far as the section of the exports says.
EXPORTS = b"\x07\x11\x02\x04call\x00\x00\x06memory\x02\x00"


@pytest.fixture
def backend(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The build backend, as pip imports it."""
    monkeypatch.syspath_prepend(str(FOLDER))
    return importlib.import_module("build_backend")


@pytest.fixture
def sources(backend: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A checkout with a few sources and no module yet."""
    for name in ("Cargo.toml", "Cargo.lock", "rust/core/Cargo.toml", "rust/core/src/lib.rs", "rust/web/src/lib.rs"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(f"// {name}\n", encoding="utf-8")
    module = tmp_path / "python/qtab.wasm"
    module.parent.mkdir()
    monkeypatch.setattr(backend, "ROOT", tmp_path)
    monkeypatch.setattr(backend, "MODULE", module)
    return tmp_path


@pytest.fixture
def cargo(backend: Any, sources: Path, monkeypatch: pytest.MonkeyPatch) -> list[dict[str, str]]:
    """A cargo whose target folder is another one; the environments in which it was called."""
    built = sources / "elsewhere/qtab_web.wasm"
    built.parent.mkdir()
    built.write_bytes(HEADER + EXPORTS)
    environments: list[dict[str, str]] = []

    def run(command: list[str], **arguments: Any) -> Any:
        assert command[:2] == ["cargo", "build"]
        environments.append(arguments["env"])
        messages = [
            {"reason": "compiler-artifact", "filenames": [str(built.parent / "libqtab_core.rlib")]},
            {"reason": "compiler-artifact", "filenames": [str(built), str(built.parent / "libqtab_web.rlib")]},
            {"reason": "build-finished", "success": True},
        ]
        return SimpleNamespace(stdout="\n".join(map(json.dumps, messages)), returncode=0)

    monkeypatch.setattr(subprocess, "run", run)
    monkeypatch.setattr(shutil, "which", lambda name: None)
    return environments


def test_the_module_is_where_cargo_says(backend, sources, cargo):
    backend.build_module()
    module = (sources / "python/qtab.wasm").read_bytes()
    assert module.startswith(HEADER + EXPORTS)
    assert backend.exports(module) == {"call", "memory"}
    assert backend.is_current(module)


def test_flags_for_the_machine_do_not_reach_the_module(backend, cargo, monkeypatch):
    monkeypatch.setenv("RUSTFLAGS", "-C target-cpu=native")
    backend.build_module()
    (environment,) = cargo
    assert "RUSTFLAGS" not in environment
    assert environment["CARGO_ENCODED_RUSTFLAGS"] == ""
    assert environment["PATH"] == os.environ["PATH"]


@pytest.mark.parametrize(
    ("present", "rustup", "works", "called", "ready"),
    [
        (True, "rustup", True, 0, True),
        (False, "rustup", True, 1, True),
        (False, "rustup", False, 1, False),  # such as offline
        (False, None, False, 0, False),  # a distribution's own Rust
    ],
)
def test_rustup_adds_a_missing_target(backend, monkeypatch, present, rustup, works, called, ready):
    targets, commands = [backend.TARGET] * present, []

    def run(command: list[str], **_: Any) -> Any:
        commands.append(command)
        if works:
            targets.append(command[-1])
        return SimpleNamespace(returncode=0 if works else 1)

    monkeypatch.setattr(backend, "has_target", lambda: backend.TARGET in targets)
    monkeypatch.setattr(shutil, "which", lambda name: rustup)
    monkeypatch.setattr(subprocess, "run", run)
    assert backend.add_target() is ready
    assert commands == [["rustup", "target", "add", backend.TARGET]] * called


@pytest.mark.parametrize("name", ["Cargo.lock", "rust/core/src/lib.rs", "rust/web/src/new.rs"])
def test_a_module_of_other_sources_is_not_packaged(backend, sources, cargo, monkeypatch, name):
    backend.build_module()
    monkeypatch.setattr(backend, "add_target", lambda: False)
    backend.prepare()
    (sources / name).write_text("// changed\n", encoding="utf-8")
    with pytest.raises(
        RuntimeError, match=r"qtab\.wasm was built from other sources, and cannot be built anew: Rust's"
    ):
        backend.prepare()


def test_a_module_without_a_digest_is_not_packaged(backend, sources, monkeypatch):
    backend.MODULE.write_bytes(HEADER + EXPORTS)
    monkeypatch.setattr(backend, "add_target", lambda: False)
    with pytest.raises(RuntimeError, match="delete the file to leave `qtab playground` out"):
        backend.prepare()


def test_without_target_and_module_the_playground_is_left_out(backend, sources, monkeypatch, capsys):
    monkeypatch.setattr(backend, "add_target", lambda: False)
    backend.prepare()
    assert "`qtab playground` is left out" in capsys.readouterr().err
    assert not backend.MODULE.exists()


@pytest.mark.parametrize(
    ("version", "returncode", "result", "warning"),
    [
        ("wasm-opt version 108", 0, HEADER + EXPORTS + b"\x00\x02\x01a", ""),
        ("wasm-opt version 123 (version_123)", 0, HEADER + EXPORTS, ""),
        ("wasm-opt version 90", 0, HEADER, "wasm-opt version 90 is older than version 108"),
        ("", 0, HEADER, "is older than version 108"),
        ("wasm-opt version 116", 1, b"", "wasm-opt 116 failed"),
        ("wasm-opt version 116", 0, HEADER, "wasm-opt 116 changed what the module exports"),
    ],
)
def test_an_optimizer_that_does_not_fit_is_not_used(
    backend, tmp_path, monkeypatch, capsys, version, returncode, result, warning
):
    built = tmp_path / "built.wasm"
    built.write_bytes(HEADER + EXPORTS)

    def run(command: list[str], **_: Any) -> Any:
        if command[1:] == ["--version"]:
            return SimpleNamespace(stdout=version, returncode=0)
        assert "--mvp-features" in command
        Path(command[-1]).write_bytes(result)
        return SimpleNamespace(returncode=returncode)

    monkeypatch.setattr(shutil, "which", lambda name: "wasm-opt")
    monkeypatch.setattr(subprocess, "run", run)
    module = backend.optimized(built)
    printed = capsys.readouterr().err
    assert warning in printed
    assert bool(printed) == bool(warning)
    assert module == (HEADER + EXPORTS if warning else result)


@pytest.mark.parametrize("length", [0, 127, 128, 70_000])
def test_a_custom_section_is_read_as_it_was_written(backend, length):
    content = bytes(length)
    module = backend.with_custom_section(HEADER + EXPORTS, "name", content)
    assert backend.custom_section(module, "name") == content
    assert backend.custom_section(module, "other") is None
    assert backend.exports(module) == {"call", "memory"}


@pytest.mark.parametrize("damaged", [b"", b"\0asm", HEADER + b"\x07", HEADER + EXPORTS[:-1]])
def test_what_is_no_module_is_refused(backend, damaged):
    with pytest.raises(ValueError, match="WebAssembly module"):
        backend.exports(damaged)
