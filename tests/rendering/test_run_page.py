"""``Run.to_html``: one page that needs nothing else."""

import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import gymnasium as gym
import pytest

import qtab
from qtab.rendering import learning, run_page

TABLE: dict[str, Any] = {
    "env": qtab.TabularEnv({0: {0: [(1.0, 1, 1.0, True)]}, 1: {0: [(1.0, 1, 0.0, True)]}}, [1.0, 0.0]),
    "episodes": 20,
    "seed": 0,
    "max_episode_steps": 5,
}


@pytest.fixture(autouse=True)
def small_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(learning, "DOTS_PER_INCH", 40)
    monkeypatch.setattr(run_page, "DOTS_PER_INCH", 40)


class Page(HTMLParser):
    """The headings, the text, and the tags with their attributes."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []
        self.headings: list[str] = []
        self.source = path.read_text(encoding="utf-8")
        self.feed(self.source)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in ("meta", "img", "input", "br"):
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] in ("h1", "h2"):
            self.headings.append(data)

    def all(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.tags if name == tag]


HEADINGS = ["Learning curve", "What it learned", "A greedy episode", "Diagnosis", "Settings", "How it was made"]


def test_a_page_has_all_parts_and_needs_nothing_else(tmp_path: Path) -> None:
    run = qtab.train("FrozenLake-v1", episodes=300, seed=0, snapshots=[0, 1, 300])
    run.to_html(tmp_path / "run.html")
    page = Page(tmp_path / "run.html")
    assert page.open == []
    assert page.headings == ["FrozenLake-v1", *HEADINGS]
    sources = [attributes["src"] or "" for tag in ("img", "video") for attributes in page.all(tag)]
    assert len(sources) == 5
    assert all(source.startswith("data:") for source in sources)
    assert not re.search(r"https?://|//cdn|<script|<link|@import|url\(", page.source)
    pictures = page.all("img")
    assert all(len(attributes["alt"] or "") > 40 for attributes in pictures)
    labels = [attributes.get("data-label") for attributes in pictures[1:]]
    assert labels == ["after 0 episodes", "after 1 episode", "after 300 episodes"]
    assert [("display:none" in (attributes["style"] or "")) for attributes in pictures[1:]] == [True, True, False]
    (control,) = page.all("input")
    assert (control["type"], control["max"], control["aria-valuetext"]) == ("range", "2", "after 300 episodes")
    assert page.all("button")[0]["type"] == "button"
    assert "prefers-color-scheme:dark" in page.source
    assert "Diagnosis of the run of FrozenLake-v1" in page.source
    for name, value in (("episodes", "300"), ("algorithm", "q_learning"), ("qtab", qtab.__version__)):
        assert f'<th scope="row">{name}</th><td>{value}</td>' in page.source


def test_without_snapshots_and_a_renderer_it_has_the_final_tables_only(tmp_path: Path) -> None:
    qtab.train(**TABLE).to_html(tmp_path / "run.html")
    page = Page(tmp_path / "run.html")
    assert page.headings[1:] == HEADINGS
    assert [attributes.get("data-label") for attributes in page.all("img")] == [None, "after 20 episodes"]
    assert page.all("input") == []
    assert "There is no video: the run&#x27;s environment &#x27;TabularEnv&#x27; is not registered" in page.source


@pytest.mark.slow
def test_many_snapshots_and_long_episodes_are_cut(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run_page, "MAX_SNAPSHOTS", 3)
    monkeypatch.setattr(run_page, "MAX_FRAMES", 5)
    run = qtab.train("FrozenLake-v1", episodes=50, seed=0, snapshots=50, env_kwargs={"desc": ["SH", "HG"]})
    run.to_html(tmp_path / "run.html")
    page = Page(tmp_path / "run.html")
    labels = [attributes.get("data-label") for attributes in page.all("img")]
    assert labels == [None, "after 1 episode", "after 49 episodes", "after 50 episodes"]
    long = qtab.train("FrozenLake-v1", episodes=1, seed=0, initial_q=0.0, epsilon=0.0, max_episode_steps=50)
    long.to_html(tmp_path / "run.html")
    assert "Its first 4 steps." in Page(tmp_path / "run.html").source


def test_texts_are_escaped_and_a_run_without_a_finished_episode_has_a_page(tmp_path: Path) -> None:
    name = "Evil<b>&-v0"
    run = qtab.train("FrozenLake-v1", episodes=5, seed=0)
    changes: dict[str, Any] = {
        one: getattr(run, one)[:0] for one in ("episode_returns", "episode_lengths", "terminated")
    }
    changes |= {"config": qtab.Config(**{**vars(run.config), "env": name}), "versions": {"<script>": "alert(1)"}}
    qtab.Run(**{**vars(run), **changes, "completed": False}).to_html(tmp_path / "run.html")
    page = Page(tmp_path / "run.html")
    assert page.headings[0] == name
    assert name not in page.source
    assert page.all("script") == []
    assert "no episode was finished" in page.source
    assert "0 of 5, 0 steps" in page.source


@pytest.mark.parametrize(
    ("path", "arguments", "message"),
    [
        (3, {}, "path must be a path, got 3"),
        ("none/run.html", {}, "path must be a file that can be written"),
        ("run.html", {"env": 3}, "env must be an environment id"),
        ("run.html", {"env": gym.make("FrozenLake-v1")}, "env must be made with render_mode='rgb_array', got None"),
        ("run.html", {"optimum": "best"}, "optimum must be a number or a result of qtab.optimum"),
        ("run.html", {"at": {"x": 1}}, "at must be None for FrozenLake-v1"),
    ],
)
def test_wrong_arguments_are_refused(
    path: Any, arguments: dict[str, Any], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    run = qtab.train("FrozenLake-v1", episodes=5, seed=0)
    with pytest.raises((TypeError, ValueError, OSError), match=message):
        run.to_html(path, **arguments)
    assert list(tmp_path.iterdir()) == []
