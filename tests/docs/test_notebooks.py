"""The notebooks in examples/: how they are stored, and that they run, show pictures and print the right numbers.

What they show is tested with ``-m docs`` only: ``.ci/run docs`` executes them for the site, and the tests read that.
``test_chapter_notebooks.py`` tests what those of the chapters show.
"""

import ast
import re
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

import qtab
from qtab.envs.metadata.goals import BEST_KNOWN_MOUNTAIN_CAR
from support.documents.notebooks import EXAMPLES, Executed, check_shown, nbformat, source, stored
from support.repository import ROOT, tracked_files

NOTEBOOKS = [
    path.relative_to(EXAMPLES).with_suffix("").as_posix()
    for path in tracked_files(".ipynb")
    if path.is_relative_to(EXAMPLES)
]
LINK = re.compile(r"\]\(([^)\s]+)\)")

PICTURES = {
    "mountain_car": "curve values policy visits trajectory solved solved-trajectory policies",
    "your_environment": "many learned day",
    "study": "sensitivity profile curves",
    "playground": "picture",
}
"""The cells that show one picture each."""
TABLES = {
    "mountain_car": "train diagnosis what-if advice gap same-numbers",
    "your_environment": "train verify optimum gap",
    "study": "search confirm improvement reload",
    "playground": "change",
}
"""The cells that show a table."""
PLAYERS = {"mountain_car": "play-article play-solved animation"}
"""The cells that show pictures in motion."""


def test_each_is_tested_and_the_readme_links_it() -> None:
    assert sorted(name for name in NOTEBOOKS if "/" not in name) == sorted(PICTURES)
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert [name for name in PICTURES if f"(examples/{name}.ipynb)" not in readme] == []


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_a_notebook_is_stored_without_what_running_it_leaves(name: str) -> None:
    notebook = stored(name)
    nbformat.validate(notebook)
    assert notebook.metadata == {
        "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
        "language_info": {"name": "python"},
    }
    assert {str(cell.metadata) for cell in notebook.cells} == {"{}"}
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert [cell.id for cell in code if cell.outputs or cell.execution_count is not None] == []
    # Words as ids: an editor that makes new ones would be seen in the difference.
    assert [cell.id for cell in notebook.cells if not re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*", cell.id)] == []
    text = (EXAMPLES / f"{name}.ipynb").read_text(encoding="utf-8")
    assert not re.search(r"/(home|Users|work|tmp)/|[A-Z]:\\\\", text)


@pytest.mark.parametrize("name", [name for name in NOTEBOOKS if name in PICTURES or name.startswith("chapters/")])
def test_a_notebook_installs_qtab_on_colab_alone(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The rehearsal of a release runs the cell where it installs something."""
    interactive = pytest.importorskip("IPython.core.inputtransformer2")
    text = source(name, "install")
    assert text == source("study", "install")
    assert stored(name).cells[1].id == "install"
    called = []
    shell = SimpleNamespace(run_line_magic=lambda *arguments: called.append(arguments))
    monkeypatch.delitem(sys.modules, "google.colab", raising=False)
    code = interactive.TransformerManager().transform_cell(text)
    for on_colab in (False, True):
        if on_colab:
            monkeypatch.setitem(sys.modules, "google.colab", ModuleType("google.colab"))
        exec(code, {"get_ipython": lambda: shell})  # noqa: S102 - our own notebook
        assert called == [("pip", 'install --quiet "qtab[all]"')] * on_colab


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_a_notebook_prints_one_value_at_a_time(name: str) -> None:
    """Several may arrive in several messages, and the site then shows them on lines of their own."""
    code = "\n".join(cell.source for cell in stored(name).cells if cell.cell_type == "code")
    tree = ast.parse(re.sub(r"^( *)%.*", r"\1pass", code, flags=re.MULTILINE))
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
    printed = [call for call in calls if isinstance(call.func, ast.Name) and call.func.id == "print"]
    assert [ast.unparse(call) for call in printed if len(call.args) > 1] == []


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_the_links_of_a_notebook_lead_to_files(name: str) -> None:
    texts = [cell.source for cell in stored(name).cells if cell.cell_type == "markdown"]
    assert texts[0].startswith("# ")
    targets = [target for text in texts for target in LINK.findall(text) if not target.startswith("https://")]
    folder = (EXAMPLES / name).parent
    assert [target for target in targets if not (folder / target.partition("#")[0]).exists()] == []


def check_mountain_car(executed: Executed) -> None:
    assert executed.text("train") == repr(qtab.train("MountainCar-v0", seed=0))
    assert str(qtab.stats.mean(qtab.train_many("MountainCar-v0", 20).final_returns())) in executed.text("seeds")
    assert "0 of 20" in executed.text("seeds")
    advice: dict[str, Any] = {
        "epsilon": 0.0,
        "initial_q": 0.0,
        "discretizer": "tiles",
        "tiles": 16,
        "terminal_update": "target",
        "discount": 1.0,
    }
    solved = qtab.train("MountainCar-v0", seed=0, **advice)
    assert solved.mean_returns(100)[-1] > -110
    assert repr(solved) in executed.text("advice")
    greedy = qtab.evaluate(solved, episodes=1000, seed=1).mean_return
    assert f"greedy policy {greedy:.2f}, best known {BEST_KNOWN_MOUNTAIN_CAR:.2f}" in executed.text("gap")
    assert "return -200 in 200 steps" in executed.text("play-article")
    assert executed.text("same-numbers").endswith("equal>")


def check_your_environment(executed: Executed) -> None:
    street: dict[str, Any] = {}
    exec(source("your_environment", "street"), street)  # noqa: S102
    customers = np.array(street["CUSTOMERS"])
    values = np.zeros((street["CUPS"] + 1, len(customers)))
    for cups in range(1, street["CUPS"] + 1):
        for _ in range(300):
            arrived = -1 + customers * values[cups - 1] + (1 - customers) * values[cups]
            values[cups] = np.max([np.roll(np.pad(arrived, 1, "edge"), move)[1:-1] for move in (-1, 0, 1)], axis=0)
    best = float(values[1:].mean())
    assert f"optimum expected return {best:.6g} within 300 steps" in executed.text("optimum")
    assert executed.text("verify") == "<Verification of CoffeeCart-v0: seed 0, 200 episodes, equal>"
    for cell in ("speed", "ordinary"):
        assert "the same Q table, bit for bit: True\n" in executed.text(cell)
    [mean] = re.findall(r"the mean return of the last 100 episodes: (\S+) \[", executed.text("many"))
    assert best - 0.1 < float(mean) < best + 0.1
    [gap] = re.findall(r"<Gap of 200 runs: .* gap (\S+)>", executed.text("gap"))
    assert 0 < float(gap) < 0.05


def check_study(executed: Executed) -> None:
    space: dict[str, Any] = {}
    exec(source("study", "design").replace("FOLDER.mkdir", "dict"), space)  # noqa: S102
    printed = executed.text("confirm").splitlines()
    final = {}
    for name, algorithm in space["ALGORITHMS"].items():
        [line] = [line for line in printed if line.startswith(f"{name}: setting")]
        setting: dict[str, Any] = {
            found: float(value) for found, value in re.findall(r"(learning_rate|trace_decay) ([\d.]+)", line)
        }
        assert setting in space["design"]
        runs = qtab.train_many("MountainCar-v0", range(10, 40), algorithm=algorithm, **setting, **space["SHARED"])
        final[name] = runs.final_returns()
        mean, iqm = qtab.stats.mean(final[name]), qtab.stats.iqm(final[name])
        assert f"{mean} over 30 other seeds" in line
        assert re.search(
            rf"{re.escape(name)} +mean {re.escape(str(mean))}   IQM {re.escape(str(iqm))}", executed.text("statistics")
        )
        assert f"solved: {qtab.stats.rate(int(np.sum(final[name] >= -110)), 30)}" in executed.text("solved")
    online, offline = final["true online Sarsa(λ)"], final["Sarsa(λ)"]
    improvement = qtab.stats.probability_of_improvement(online, offline)
    assert improvement.low < 0.5 < improvement.high  # as the conclusion says
    assert f"probability of improvement: {improvement}" in executed.text("improvement")
    assert repr(qtab.stats.compare(online, offline)) in executed.text("improvement")
    assert {"report.html", "learning_curves.pdf", "sarsa_lambda.db"} < set(executed.text("report").split())
    assert executed.text("reload").startswith("the same means: True\n")


def check_playground(executed: Executed) -> None:
    """The values that were assigned to widgets reach the agent."""
    settings: dict[str, Any] = {"learning_rate": 0.2, "discount": 1.0, "epsilon": 0.0, "episodes": 1000}
    assert executed.text("change") == repr(qtab.train("MountainCar-v0", seed=0, **settings))
    runs = qtab.train_many("MountainCar-v0", seeds=100, **settings)
    assert f"episodes: {qtab.stats.mean(runs.final_returns(100))}" in executed.text("seeds")


CHECKS: dict[str, Callable[[Executed], None]] = {
    "mountain_car": check_mountain_car,
    "your_environment": check_your_environment,
    "study": check_study,
    "playground": check_playground,
}


@pytest.mark.docs
@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # of Jupyter's libraries
@pytest.mark.parametrize("name", PICTURES)
def test_a_notebook_runs_and_shows_what_it_says(name: str, tmp_path: Path) -> None:
    check_shown(
        name,
        tmp_path,
        pictures=PICTURES[name],
        tables=TABLES[name],
        players=PLAYERS.get(name, ""),
        check=CHECKS[name],
    )
