"""The pages of the repository: their links and paths exist, their pictures are described, their code runs."""

import re
import sys
from pathlib import Path
from typing import Any

import pytest

import qtab
from support.repository import ROOT, tracked_files

PAGES = [path for path in tracked_files(".md") if path.parent in (ROOT, ROOT / "docs", ROOT / "docs/book")]
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)")
PYTHON = re.compile(r"^```python\n(.*?)^```", re.DOTALL | re.MULTILINE)


def anchor(heading: str) -> str:
    """The fragment that GitHub gives a heading."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def page_id(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


@pytest.mark.parametrize("page", PAGES, ids=page_id)
def test_links_lead_to_files_and_headings_that_exist(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    anchors = {anchor(heading) for heading in re.findall(r"^#+ (.+)$", text, re.MULTILINE)}
    for _, _, target in LINK.findall(text):
        if target.startswith("https://"):
            continue
        path, _, fragment = target.partition("#")
        assert (page.parent / path).exists(), target
        assert path or fragment in anchors, target


@pytest.mark.parametrize("page", PAGES, ids=page_id)
def test_every_picture_has_an_alternative_text(page: Path) -> None:
    for picture, text, target in LINK.findall(page.read_text(encoding="utf-8")):
        assert not picture or len(text) > 40, target


def test_the_paths_that_contributing_names_exist() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    layout = re.search(r"## Where things are\n\n```\n(.*?)```", text, re.DOTALL)
    assert layout is not None
    folder = ROOT
    paths = []
    for line in layout.group(1).splitlines():
        names = re.match(r"( *)(\S+(?: \S+)*)", line)
        assert names is not None, line
        if not names.group(1):
            folder = ROOT / names.group(2).split()[0]
            paths += [ROOT / name for name in names.group(2).split()]
        else:
            paths += [folder / name for name in names.group(2).split()]
    paths += [ROOT / name for name in re.findall(r"`((?:rust|python|tests|docs)/[\w./-]+)`", text)]
    assert len(paths) > 30
    assert [path for path in paths if not path.exists()] == []


def test_the_readme_has_its_two_commands() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    for marker, end in (("train", "qtab train --plot rewards.png --save run.npz"), ("test", "-m pytest")):
        assert re.search(rf"<!-- {marker} -->\n```sh\npython3 -m venv \.venv && .*{re.escape(end)}\n```", text), marker


def test_the_readmes_python_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In order and in one namespace, as a reader would paste it, with fewer seeds and snapshots."""
    monkeypatch.chdir(tmp_path)
    blocks = PYTHON.findall((ROOT / "README.md").read_text(encoding="utf-8"))
    namespace: dict[str, object] = {}
    for block in blocks:
        fewer = re.sub(r"snapshots=\d+", "snapshots=2", re.sub(r"seeds=\d+", "seeds=4", block))
        exec(fewer, namespace)  # noqa: S102 - our own page
    assert len(blocks) > 5
    assert isinstance(namespace["run"], qtab.Run)
    assert (tmp_path / "learning_curve.png").stat().st_size > 0


def test_the_python_of_the_page_on_actions_runs() -> None:
    namespace: dict[str, Any] = {}
    for block in PYTHON.findall((ROOT / "docs/actions.md").read_text(encoding="utf-8")):
        exec(block, namespace)  # noqa: S102 - our own page
    assert namespace["run"].action_names[1] == "{dimmer: 1, lamps: (0, 1)}"
    assert repr(namespace["run"].predict(0)[0]) == "{'dimmer': 2, 'lamps': array([1, 1], dtype=int8)}"
    assert namespace["taxi"].action_masks.shape == (500, 6)
    assert namespace["lake"].config.backend == "rust"


class Recorder:
    """Stands for a tracking library: takes any call, and writes down its name and arguments."""

    def __init__(self) -> None:
        self.calls: list[tuple[str, tuple[Any, ...], dict[str, Any]]] = []

    def __getattr__(self, name: str) -> Any:
        def call(*arguments: Any, **keywords: Any) -> "Recorder":
            self.calls.append((name, arguments, keywords))
            return self

        return call


@pytest.mark.slow
def test_the_python_of_the_page_on_callbacks_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In order and in one namespace; the tracking libraries, which are not installed, write down their calls."""
    monkeypatch.chdir(tmp_path)
    libraries = {name: Recorder() for name in ("wandb", "mlflow")}
    for name, library in libraries.items():
        monkeypatch.setitem(sys.modules, name, library)
    namespace: dict[str, Any] = {}
    for block in PYTHON.findall((ROOT / "docs/callbacks.md").read_text(encoding="utf-8")):
        exec(block, namespace)  # noqa: S102 - our own page
    assert len(qtab.load("best.npz").episode_returns) <= len(qtab.load("run.npz").episode_returns)
    assert namespace["run"].episode_returns[-100:].mean() >= -105
    assert Path("log.csv").read_text().count("\n") == len(namespace["run"].episode_returns) // 100 + 1
    assert [name for name, _, _ in libraries["wandb"].calls] == ["init", *["log"] * 50, "finish"]
    mlflow = ["start_run", "log_params", *["log_metrics"] * 10, "end_run"]
    assert [name for name, _, _ in libraries["mlflow"].calls] == mlflow
    for _, (values,), keywords in libraries["wandb"].calls[1:-1] + libraries["mlflow"].calls[2:-1]:
        assert set(values) == {"return", "epsilon"}
        assert keywords["step"] % 100 == 0
    assert len(namespace["runs"]) % 16 == 0
