"""Links types in the reference by their public names, such as ``qtab.Run`` for ``qtab.results.run.Run``."""

import importlib
from functools import cache
from typing import Any

from docutils import nodes
from sphinx.addnodes import pending_xref
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.ext import intersphinx

import qtab

SHORT = {
    name.rpartition(".")[2]: name
    for name in (
        "collections.abc.Callable",
        "collections.abc.Iterable",
        "collections.abc.Iterator",
        "collections.abc.Mapping",
        "collections.abc.Sequence",
        "concurrent.futures.Executor",
        "gymnasium.Env",
        "gymnasium.Space",
        "gymnasium.envs.registration.EnvSpec",
        "gymnasium.vector.AutoresetMode",
        "gymnasium.vector.VectorEnv",
        "matplotlib.axes.Axes",
        "matplotlib.figure.Figure",
        "numpy.bool_",
        "numpy.float32",
        "numpy.float64",
        "numpy.floating",
        "numpy.int64",
        "numpy.int8",
        "numpy.integer",
        "numpy.ndarray",
        "numpy.typing.ArrayLike",
        "numpy.typing.NDArray",
        "numpy.uint32",
        "numpy.uint8",
        "os.PathLike",
        "pandas.DataFrame",
        "typing.Any",
        "typing.Literal",
        "typing.Self",
    )
} | {
    "gymnasium.core.Env": "gymnasium.Env",
    "gymnasium.vector.vector_env.AutoresetMode": "gymnasium.vector.AutoresetMode",
    "gymnasium.vector.vector_env.VectorEnv": "gymnasium.vector.VectorEnv",
    "numpy.random._generator.Generator": "numpy.random.Generator",
    "pa.Table": "pyarrow.Table",
    "stable_baselines3.common.vec_env.base_vec_env.VecEnv": "stable_baselines3.common.vec_env.VecEnv",
}
"""The full names of types that signatures shorten to their last part, and of types defined elsewhere."""
WITHOUT_A_PAGE = ("Estimates", "SharedSettings", "ValuesVerification", "WhatIf")
"""Types of this package that have no page and are named without their module."""
MODULES = ("book", "callbacks", "designs", "planning", "playground", "plots", "prediction", "stats")
"""The modules among the public names, whose own names are public too."""


@cache
def public() -> dict[str, str]:
    """Returns the public name of each object by the name under which it is defined."""
    names = {f"qtab.{name}": getattr(qtab, name) for name in qtab.__all__ if name != "sb3"}
    for module in MODULES:
        names |= {
            f"qtab.{module}.{name}": getattr(names[f"qtab.{module}"], name) for name in names[f"qtab.{module}"].__all__
        }
    found: dict[str, str] = {}
    for name, value in names.items():
        if hasattr(value, "__qualname__"):
            found.setdefault(f"{value.__module__}.{value.__qualname__}", name)
            found.setdefault(value.__qualname__, name)  # annotations that are strings
    return found


def exists(name: str) -> bool:
    """Whether a dotted name can be imported."""
    parts = name.split(".")
    for length in range(len(parts), 0, -1):
        try:
            value: Any = importlib.import_module(".".join(parts[:length]))
        except ImportError:
            continue
        try:
            for part in parts[length:]:
                value = getattr(value, part)
        except AttributeError:
            return False
        return True
    return False


def resolve(app: Sphinx, env: BuildEnvironment, node: pending_xref, content: nodes.TextElement) -> nodes.Node | None:
    """Links to a public name, or shows a name that has no page as text."""
    if node.get("refdomain") != "py":
        return None
    target = str(node["reftarget"])
    if name := public().get(target):
        domain = env.domains["py"]
        return domain.resolve_xref(env, node["refdoc"], app.builder, "obj", name, node, content)
    if target in WITHOUT_A_PAGE or (target.startswith("qtab.") and exists(target)):
        return content
    if target in SHORT:
        node["reftarget"] = SHORT[target]
        return intersphinx.missing_reference(app, env, node, content)
    return None


def setup(app: Sphinx) -> dict[str, bool]:
    """Registers the resolution."""
    app.connect("missing-reference", resolve)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
