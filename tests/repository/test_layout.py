"""The layout of the repository: few modules at the top, imports in one direction, short files and folders."""

import ast
import functools
import re
from collections import Counter
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

from support.repository import PACKAGE, ROOT, tracked_files

MAX_TOP_LEVEL_MODULES = 8
MAX_LINES = 300
MAX_ENTRIES = 16
CROWDED = {
    "docs/book/pictures": "one picture per figure of the book",
    "docs/gallery/pictures": "one picture per block of code in the gallery",
    "docs/how_to": "one page per question; the path of a page is its address",
    "python/qtab": "one folder per subject; the path of a module is how it is imported",
    "python/qtab/discretizers": "one discretizer per file; pickled runs name its module",
    "rust/core/src": "the modules of the crate, which users name in paths",
    "tests": "the folders of python/qtab, and those of what has no folder there",
}
"""The folders with more entries than ``MAX_ENTRIES``, and the reason for each."""

ORDER = (
    {"_utils"},
    {"_spec", "compilation", "config", "discretizers", "envs"},
    {"reference"},
    {"results"},
    {"training"},
    {"planning"},
    {"stats"},
    {"sweeps"},
    {"plots"},
    {"diagnosis"},
    {"explanation"},
    {"rendering"},
    {"callbacks"},
    {"prediction"},
    {"sb3"},
    {"book"},
    {"exercises"},
    {"playground"},
    {"cli"},
    {"", "__main__"},
)
"""The packages in the order of their imports: each imports only those before it and those in the same set."""

CRATE_ORDERS = {
    "core": (
        {"checkpoint", "simd", "stop_flag"},
        {"memory", "numeric"},
        {"errors", "random", "schedules"},
        {"features"},
        {"policies", "q_table"},
        {"envs"},
        {"planning", "vector"},
        {"tasks"},
        {"learners"},
        {"prediction", "settings"},
        {"trainer"},
        {"batch"},
    ),
    "python": (
        {"locks"},
        {"error", "interrupt"},
        {"convert"},
        {"rng"},
        {"spec", "vector"},
        {"discretizer", "runs"},
        {"envs"},
        {"planning", "training"},
    ),
    "web": (
        {"failure", "json"},
        {"environment", "learners"},
        {"settings", "updates"},
        {"map"},
        {"runs"},
        {"report"},
        {"playground"},
        {"exports"},
    ),
}
"""The top-level modules of each crate in the order of their uses: each uses only those in the sets before its own."""

Graph = dict[str, set[str]]


def modules() -> dict[str, Path]:
    """Every module of the package by its full name; a package has the name of its folder."""
    named = {}
    for path in PACKAGE.rglob("*.py"):
        parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
        named[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return named


def import_statements(node: ast.AST, in_function: bool = False) -> Iterator[tuple[ast.Import | ast.ImportFrom, bool]]:
    """Every import below a node, and whether it is inside a function. Imports for type checkers are left out."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.Import | ast.ImportFrom):
            yield child, in_function
        elif isinstance(child, ast.If) and isinstance(child.test, ast.Name) and child.test.id == "TYPE_CHECKING":
            continue
        else:
            yield from import_statements(child, in_function or isinstance(child, ast.FunctionDef))


@functools.cache
def imports_of(path: Path) -> list[tuple[ast.Import | ast.ImportFrom, bool]]:
    """The imports of a file, and whether each is inside a function."""
    return list(import_statements(ast.parse(path.read_text(encoding="utf-8"))))


def imported_names(statement: ast.Import | ast.ImportFrom) -> list[str]:
    """The full names that a statement may bind: ``from qtab import envs`` names ``qtab.envs``."""
    if isinstance(statement, ast.Import):
        return [alias.name for alias in statement.names]
    return [f"{statement.module}.{alias.name}" for alias in statement.names]


def import_graph(with_functions: bool) -> Graph:
    """For each module of the package the modules that it imports."""
    known = modules()
    graph: Graph = {name: set() for name in known}
    for name, path in known.items():
        for statement, in_function in imports_of(path):
            if in_function and not with_functions:
                continue
            for imported in imported_names(statement):
                target = imported if imported in known else imported.rpartition(".")[0]
                if target in known and target != name:
                    graph[name].add(target)
    return graph


def cycle(graph: Graph) -> list[str]:
    """A circle of imports, or an empty list."""
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(error.args[1])
    return []


def test_few_modules_lie_directly_in_the_package() -> None:
    top = sorted(path.name for path in PACKAGE.glob("*.py"))
    assert len(top) <= MAX_TOP_LEVEL_MODULES, top


def test_imports_are_absolute() -> None:
    relative = [
        f"{path.relative_to(ROOT)}:{statement.lineno}"
        for path in modules().values()
        for statement, _ in imports_of(path)
        if isinstance(statement, ast.ImportFrom) and statement.level
    ]
    assert relative == []


@pytest.mark.parametrize("with_functions", [False, True], ids=["at the top of modules", "inside functions too"])
def test_modules_do_not_import_each_other_in_a_circle(with_functions: bool) -> None:
    graph = import_graph(with_functions)
    assert len(graph) > 50, "the package was not found"
    assert cycle(graph) == []


def named_modules(path: Path, known: dict[str, Path]) -> Iterator[str]:
    """The modules of the package that a file names: in imports, those for type checkers included, and as texts."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        names = imported_names(node) if isinstance(node, ast.Import | ast.ImportFrom) else []
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            names = [node.value]
        for name in names:
            found = name if name in known else name.rpartition(".")[0]
            if found in known and found != "qtab":  # `from qtab import _core`, the extension; or a text "qtab"
                yield found


def package_of(module: str) -> str:
    """The package of a module below ``qtab``; an empty text for ``qtab`` itself."""
    return module.split(".")[1] if "." in module else ""


def test_packages_import_only_those_below_them() -> None:
    known = modules()
    place = {package: index for index, group in enumerate(ORDER) for package in group}
    assert place.keys() == {package_of(name) for name in known}
    upwards = [
        f"{name} names {other}"
        for name, path in known.items()
        for other in named_modules(path, known)
        if place[package_of(other)] > place[package_of(name)]
    ]
    assert upwards == []


def test_a_circle_of_imports_would_be_found() -> None:
    assert cycle({"a": {"b"}, "b": {"c"}, "c": {"a"}, "d": {"a"}})


def without_tests(source: str) -> str:
    """Rust code without comments, and without the modules and imports that are compiled for tests only."""
    source = re.sub(r"//.*", "", source)
    source = re.sub(r"^#\[cfg\(test\)\]\n(?:pub\S* )?mod \w+ \{.*?^\}$", "", source, flags=re.MULTILINE | re.DOTALL)
    return re.sub(r"^#\[cfg\(test\)\]\n[^;{]*;", "", source, flags=re.MULTILINE)


def used_in_crate(source: str, depth: int) -> set[str]:
    """The names at the root of its crate that Rust code uses, so many modules below the root."""
    root = r"(?:\bcrate::|(?<![\w:])" + "super::" * depth + ")"
    groups = re.findall(root + r"\{([^;]*)\};", source)
    return set(re.findall(root + r"(\w+)", source)) | {
        name for group in groups for name in re.findall(r"(?:^|, )\s*(\w+)", re.sub(r"\{[^}]*\}", "", group))
    }


def module_graph(crate: str) -> Graph:
    """For each top-level module of a crate the others that it uses, by path or by a name that ``lib.rs`` exports."""
    sources = ROOT / "rust" / crate / "src"
    exports = re.findall(r"^pub use (\w+)::\{?([^;}]+)\}?;", (sources / "lib.rs").read_text(), re.MULTILINE)
    home = {name: module for module, names in exports for name in re.findall(r"\w+", names)}
    graph: Graph = {}
    for path in sources.rglob("*.rs"):
        parts = path.relative_to(sources).with_suffix("").parts
        if parts == ("lib",) or "tests" in parts or parts[-1] in {"tests", "test_support"}:
            continue
        depth = len(parts) - (parts[-1] == "mod")
        used = used_in_crate(without_tests(path.read_text(encoding="utf-8")), depth)
        graph.setdefault(parts[0], set()).update(home.get(name, name) for name in used)
    return {module: (used & graph.keys()) - {module} for module, used in graph.items()}


@pytest.mark.parametrize("crate", CRATE_ORDERS)
def test_modules_of_a_crate_use_only_those_below_them(crate: str) -> None:
    graph = module_graph(crate)
    place = {module: index for index, group in enumerate(CRATE_ORDERS[crate]) for module in group}
    assert place.keys() == graph.keys()
    assert sum(map(len, graph.values())) > 20, "the uses were not found"
    upwards = [f"{module} uses {used}" for module in graph for used in graph[module] if place[used] >= place[module]]
    assert upwards == []


def test_uses_in_rust_are_found() -> None:
    source = "use crate::{Task, envs::Env};\nuse super::random::Rng;\n"
    test = "#[cfg(test)]\nmod tests {\n    use crate::trainer;\n}\n"
    assert used_in_crate(without_tests(source + test), 1) == {"Task", "envs", "random"}


@pytest.mark.parametrize("crate", ["core", "python"])
def test_no_two_rust_types_have_the_same_name(crate: str) -> None:
    defined = re.compile(r"^(?:pub(?:\([^)]*\))? )?(?:struct|enum|trait|union) (\w+)", re.MULTILINE)
    sources = [path for path in tracked_files(".rs") if path.is_relative_to(ROOT / "rust" / crate / "src")]
    names = Counter(name for path in sources for name in defined.findall(path.read_text(encoding="utf-8")))
    assert len(names) > 10, "the sources were not found"
    assert [name for name, count in names.items() if count > 1] == []


def test_no_folder_has_many_entries() -> None:
    entries: dict[str, set[str]] = {}
    for path in tracked_files(""):
        names = path.relative_to(ROOT).parts
        for depth in range(1, len(names)):
            entries.setdefault("/".join(names[:depth]), set()).add(names[depth])
    assert len(entries) > 100, "the folders were not found"
    crowded = {folder: len(names) for folder, names in entries.items() if len(names) > MAX_ENTRIES}
    assert {folder: count for folder, count in crowded.items() if folder not in CROWDED} == {}


def test_the_root_has_documents_and_settings_only() -> None:
    """A test that writes into the current folder, and not into its temporary one, leaves its file there."""
    names = [path.name for path in tracked_files("") if path.parent == ROOT]
    assert len(names) > 10, "the root was not found"
    expected = {".cff", ".lock", ".md", ".toml", ""}
    assert [name for name in names if Path(name).suffix not in expected and not name.startswith(".")] == []


def test_no_source_file_is_long() -> None:
    lines = {
        str(path.relative_to(ROOT)): len(path.read_bytes().splitlines()) for path in tracked_files(".py", ".pyi", ".rs")
    }
    assert len(lines) > 200, "the sources were not found"
    assert {name: count for name, count in lines.items() if count > MAX_LINES} == {}
