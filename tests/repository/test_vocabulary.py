"""No private word is left: the code names things as the field does."""

import ast
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

from support.documents.old_words import ALLOWED, DEFINITIONS, VARIABLES, WORDS
from support.repository import ROOT, tracked_files

EXCLUDED = {"tests/support/documents/old_words.py", "tests/repository/test_vocabulary.py"}

RUST_COMMENT_OR_STRING = re.compile(r'//.*|b?"(?:[^"\\]|\\.)*"')
RUST_DEFINITION = re.compile(
    r"\b(?:fn|struct|enum|union|trait|type|mod|const|static)\s+(?P<item>[A-Za-z_]\w*)"
    r"|^\s*(?:pub(?:\([^)]*\))?\s+)?(?P<field>[a-z_]\w*)\s*:(?!:)"
    r"|^\s*(?P<variant>[A-Z]\w*)\s*(?:,|\{|\(|=)"
)
RUST_VARIABLE = re.compile(r"\blet\s+(?:mut\s+)?(?P<local>[a-z_]\w*)|\b(?P<parameter>[a-z_]\w*)\s*:(?!:)")

Found = tuple[int, str]
"""A line and a word in it."""


def words(_: Path, text: str) -> Iterator[Found]:
    for number, line in enumerate(text.splitlines(), 1):
        for word in re.findall(r"\w+", line):
            yield number, word


def rust_names(text: str, pattern: re.Pattern[str]) -> Iterator[Found]:
    for number, line in enumerate(text.splitlines(), 1):
        for found in pattern.finditer(RUST_COMMENT_OR_STRING.sub('""', line)):
            yield number, found[found.lastgroup or 0]


def python_definitions(text: str) -> Iterator[Found]:
    for node in ast.walk(ast.parse(text)):
        match node:
            case ast.FunctionDef() | ast.AsyncFunctionDef() | ast.ClassDef():
                yield node.lineno, node.name
            case ast.AnnAssign(target=ast.Name(id=name)) | ast.Attribute(attr=name, ctx=ast.Store()):
                yield node.lineno, name


def python_variables(text: str) -> Iterator[Found]:
    for node in ast.walk(ast.parse(text)):
        match node:
            case ast.arg(arg=name) | ast.Name(id=name, ctx=ast.Store()):
                yield node.lineno, name


def definitions(path: Path, text: str) -> Iterator[Found]:
    yield 1, path.stem
    if path.suffix == ".rs":
        yield from rust_names(text, RUST_DEFINITION)
    elif path.suffix in (".py", ".pyi"):
        yield from python_definitions(text)


def variables(path: Path, text: str) -> Iterator[Found]:
    yield from definitions(path, text)
    if path.suffix == ".rs":
        yield from rust_names(text, RUST_VARIABLE)
    elif path.suffix in (".py", ".pyi"):
        yield from python_variables(text)


def old_words(name: str, path: Path) -> Iterator[str]:
    """A line for each old word in a file, with the word to use instead."""
    text = path.read_text(encoding="utf-8")
    used = {path.stem, *re.findall(r"\w+", text)}
    for folder in WORDS:
        if name.startswith(f"{folder}/") or path.suffix == ".md":
            for table, search in (WORDS, words), (DEFINITIONS, definitions), (VARIABLES, variables):
                instead = table.get(folder, {})
                if not used.isdisjoint(instead):
                    for number, word in search(path, text):
                        if word in instead and (name, word) not in ALLOWED:
                            yield f"{name}:{number}: {word!r}, use {instead[word]!r}"


def test_no_private_word_is_left() -> None:
    files = {path.relative_to(ROOT).as_posix(): path for path in tracked_files(".rs", ".py", ".pyi", ".md")}
    assert len(files) > 200, "the sources were not found"
    left = {line: None for name in sorted(files.keys() - EXCLUDED) for line in old_words(name, files[name])}
    if left:
        pytest.fail(f"{len(left)} private words are left:\n" + "\n".join(left), pytrace=False)


def test_every_exception_is_needed() -> None:
    for (name, word), reason in ALLOWED.items():
        path = ROOT / name
        assert word in {found for _, found in words(path, path.read_text(encoding="utf-8"))}, (name, word)
        assert reason


def test_definitions_are_found() -> None:
    rust = "pub struct Lit { \n pub(crate) lit: usize }\nlet mut here = 3; // there: no\n  Goes,\nfn stir(half: u64) {}"
    assert [name for _, name in rust_names(rust, RUST_DEFINITION)] == ["Lit", "lit", "Goes", "stir"]
    assert [name for _, name in rust_names(rust, RUST_VARIABLE)] == ["lit", "here", "half"]
    python = "class Told:\n    lit: int = 3\ndef stage(here):\n    self.shown = here.lit\n    for there in here: pass"
    assert Counter(name for _, name in python_definitions(python)) == Counter(["Told", "stage", "lit", "shown"])
    assert {name for _, name in python_variables(python)} == {"lit", "here", "there"}
