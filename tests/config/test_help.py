"""help() shows what the fields of a dataclass mean, with their types as the source writes them."""

import dataclasses
import inspect
import pydoc

import pytest

import qtab

CLASSES = [
    *(qtab.Config, qtab.Evaluation, qtab.Gap, qtab.Optimum, qtab.Progress, qtab.Run, qtab.Runs),
    qtab.Verification,
]


@pytest.mark.parametrize("kind", CLASSES, ids=lambda kind: kind.__name__)
def test_every_documented_field_is_in_the_docstring(kind):
    attributes = (inspect.getdoc(kind) or "").split("Attributes:\n")[1]
    explained = [line.split()[0] for line in attributes.splitlines() if line.startswith("    ") and line[4] != " "]
    names = [field.name for field in dataclasses.fields(kind)]
    assert set(explained) <= set(names)
    assert len(explained) >= len(names) - 6
    assert max(len(line) for line in attributes.splitlines()) <= 112


def test_the_types_of_arrays_are_short():
    shown = pydoc.plain(pydoc.render_doc(qtab.Evaluation))
    # In one line, or from Python 3.13 on with a line for each argument.
    assert "returns: NDArray[np.float64]," in shown
    assert "lengths: NDArray[np.int64]," in shown
    assert "returns (NDArray[np.float64]): (episodes,): the sum of rewards of each episode." in shown
