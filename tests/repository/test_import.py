"""Importing is light, all public names resolve, and errors about missing extras name the command to install them."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

import qtab
from qtab import _core
from support.repository import ROOT


def in_a_process(code):
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=600).stdout


MODULES = ["book", "callbacks", "designs", "exercises", "planning", "playground", "plots", "prediction", "sb3", "stats"]
HEAVY = "matplotlib", "tqdm", "pygame", "PIL", "tomllib", "numba", "IPython", "tensorboardX"


def test_importing_loads_no_plotting_video_or_command_line_library():
    code = f"import sys, qtab; print([name for name in {HEAVY!r} if name in sys.modules])"
    assert in_a_process(code).strip() == "[]"


def test_training_loads_no_plotting_video_or_command_line_library():
    code = f"""
import sys, qtab
qtab.evaluate(qtab.train("MountainCar-v0", seed=0, episodes=3), 2, seed=0)
print([name for name in {HEAVY!r} if name in sys.modules and name != "tqdm"])
"""
    assert in_a_process(code).strip() == "[]"


def test_training_loads_no_other_discretizer_and_no_part_for_files_and_resumed_runs():
    code = """
import sys, qtab
qtab.train("MountainCar-v0", seed=0, episodes=3)
print(sorted(name.removeprefix("qtab.") for name in sys.modules if name.startswith("qtab.")))
"""
    loaded = set(ast.literal_eval(in_a_process(code)))
    assert loaded >= {"training.train", "discretizers.rounding"}
    assert not loaded & {"discretizers.bins", "discretizers.composite", "discretizers.tile_coding"}
    assert not loaded & {"envs.external.capsule", "envs.origin.describe", "results.file_parts", "results.loading"}
    assert not loaded & {"training.earlier_run", "training.restore", "training.setup.run_env"}


def test_the_command_loads_no_part_that_a_training_does_not_use():
    code = """
import sys
from qtab.cli import main
main(["train", "--episodes", "3", "--quiet"])
parts = "diagnosis", "explanation", "planning", "plots", "prediction", "reference", "sweeps"
others = "typeguard", "unittest.mock", "importlib.metadata", "matplotlib", "pygame"
print([name for name in (*(f"qtab.{part}" for part in parts), *others) if name in sys.modules])
"""
    assert in_a_process(code).strip() == "[]"


def test_the_help_of_the_command_loads_no_subcommand():
    code = "import sys; sys.modules['qtab.cli.parser'] = None; from qtab.cli import main; main(['--help'])"
    assert "train a tabular agent" in in_a_process(code)


def test_importing_registers_the_environments():
    code = "import gymnasium as gym, qtab; print([name for name in gym.registry if name.startswith('qtab/')])"
    assert "qtab/MountainCar-v0" in in_a_process(code)


def test_importing_does_not_draw_from_numpys_global_generator():
    code = """
import numpy as np
np.random.seed(3); expected = np.random.random(); np.random.seed(3)
import qtab
for bit_generator in ("PCG64", "MT19937"):
    qtab.verify(qtab.train("MountainCar-v0", seed=0, episodes=2, bit_generator=bit_generator))
print(np.random.random() == expected)
"""
    assert in_a_process(code).strip() == "True"


def test_a_missing_plotting_library_is_named_with_the_command_that_installs_it():
    code = """
import sys
sys.modules["matplotlib"] = None
sys.modules["matplotlib.figure"] = None
import qtab
try:
    qtab.plot(qtab.train("MountainCar-v0", seed=0, episodes=100))
except ModuleNotFoundError as error:
    print(error)
"""
    message = in_a_process(code)
    assert "matplotlib" in message
    assert "pip install 'matplotlib>=3.9' 'pillow>=10'" in message


@pytest.mark.parametrize("name", vars(qtab)["__all__"])
def test_every_public_name_resolves_and_is_documented(name):
    value = getattr(qtab, name)
    assert value.__doc__
    assert len(value.__doc__) > 20
    assert name in dir(qtab)


@pytest.mark.slow
def test_no_module_shadows_a_public_name():
    code = """
import importlib, pkgutil, types, qtab
for module in pkgutil.iter_modules(qtab.__path__):
    if module.name != "__main__":
        importlib.import_module(f"qtab.{module.name}")
print([name for name in qtab.__all__ if isinstance(getattr(qtab, name), types.ModuleType)])
"""
    assert in_a_process(code).strip() == repr(MODULES)


def test_every_name_of_the_extension_module_is_in_its_stub():
    stub = Path(qtab.__file__).with_name("_core.pyi").read_text()
    public = [name for name in dir(_core) if not name.startswith("_")]
    assert public
    for name in public:
        assert f'"{name}"' in stub, name


def test_type_checkers_see_the_table_of_public_names():
    tree = ast.parse(Path(qtab.__file__).read_text())
    (block,) = (node for node in tree.body if isinstance(node, ast.If))
    imported = {}
    for statement in block.body:
        if isinstance(statement, ast.ImportFrom):
            for alias in statement.names:
                assert alias.asname == alias.name  # only then is it public to them
                imported[alias.name] = statement.module
    modules = {name: f"{module}.{name}" for name, module in imported.items() if name in MODULES}
    assert imported | modules == qtab._MODULES


def test_only_public_names_are_shown():
    code = "import qtab; print([name for name in dir(qtab) if not name.startswith('__')] == sorted(qtab.__all__))"
    assert in_a_process(code).strip() == "True"
    assert "__version__" in dir(qtab)
    assert dir(qtab) == sorted(set(dir(qtab)))


@pytest.mark.parametrize("name", MODULES)
def test_only_public_names_of_the_modules_are_shown(name):
    module = getattr(qtab, name)
    assert [shown for shown in dir(module) if not shown.startswith("__")] == sorted(module.__all__)
    assert "__doc__" in dir(module)


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="module 'qtab' has no attribute 'trian'"):
        _ = qtab.trian  # type: ignore[attr-defined]


def test_the_version_is_that_of_the_distribution():
    from importlib.metadata import version

    assert qtab.__version__ == version("qtab")


@pytest.mark.parametrize(
    ("cargo", "metadata"),
    [
        ("1.2.3", "1.2.3"),
        ("1.2.3-rc.1", "1.2.3rc1"),
        ("1.2.3-beta.12", "1.2.3b12"),
        ("1.2.3-alpha.2", "1.2.3a2"),
    ],
)
def test_the_version_of_a_candidate_is_spelled_as_in_the_metadata(cargo, metadata):
    from packaging.version import Version

    from qtab._utils.versions import distribution_version

    assert distribution_version(cargo) == metadata == str(Version(cargo))


def test_what_training_imports_is_declared():
    tomllib = pytest.importorskip("tomllib")  # of Python 3.11
    tables = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    declared = {re.split(r"[^\w-]", one)[0].replace("-", "_") for one in tables["dependencies"]}
    code = """
import sys
import qtab
run = qtab.train("FrozenLake-v1", seed=0, episodes=3)
qtab.diagnose(run), qtab.optimum(run), qtab.sweep("FrozenLake-v1", {"epsilon": [0.1]}, seeds=1, episodes=3)
print(*(name for name, module in sys.modules.items() if name.startswith("qtab") and getattr(module, "__file__", None)))
"""
    imported = set()
    for name in in_a_process(code).split():
        path = Path(sys.modules["qtab"].__path__[0]).parent.joinpath(*name.split("."))
        source = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
        if source.exists():  # not the extension
            imported |= imported_at_once(ast.parse(source.read_text(encoding="utf-8")))
    assert imported - sys.stdlib_module_names - {"qtab"} == declared


def imported_at_once(module):
    """The packages that a module imports when it is imported itself."""
    found = set()
    for statement in module.body:
        if isinstance(statement, ast.ImportFrom):
            found.add((statement.module or "").partition(".")[0])
        elif isinstance(statement, ast.Import):
            found |= {alias.name.partition(".")[0] for alias in statement.names}
    return found


def test_the_extension_tells_its_build_profile():
    assert _core.BUILD_PROFILE in ("debug", "release")


GIVEN = {"qtab", "IPython"}
"""The package itself; what is only used where it runs already."""
DISTRIBUTIONS = {"PIL": "pillow", "pygame": "pygame-ce"}


def test_every_library_that_is_imported_is_declared():
    from importlib.metadata import requires

    imported = set()
    for path in Path(qtab.__file__).parent.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                imported |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module is not None and not node.level:
                imported.add(node.module.partition(".")[0])
    libraries = imported - set(sys.stdlib_module_names) - GIVEN
    assert libraries >= {"numpy", "matplotlib", "imageio_ffmpeg"}
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8").split("[project.optional-dependencies]")[1]
    declared = set(re.findall(r'"([\w-]+)', project.partition("\n\n")[0])) | {"gymnasium", "numpy"}
    # What Gymnasium needs is always there, and its extras are among those of this package.
    declared |= {re.match(r"[\w-]+", requirement)[0] for requirement in requires("gymnasium") or []}  # type: ignore[index]
    names = {name.lower().replace("_", "-") for name in declared}
    assert {name for name in libraries if DISTRIBUTIONS.get(name, name).lower().replace("_", "-") not in names} == set()
