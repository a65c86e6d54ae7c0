"""``qtab.animate``: the tables over the snapshots, on one scale of colors."""

import re
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import qtab
from qtab.rendering import learning
from qtab.rendering.learning import draw_learning, runs_at_snapshots
from support.parity import assert_same_run

SETTINGS: dict[str, Any] = {"episodes": 60, "seed": 0, "snapshots": [1, 20, 60]}


@pytest.fixture(autouse=True)
def small_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(learning, "DOTS_PER_INCH", 40)


@pytest.fixture(scope="module")
def cliff() -> qtab.Run:
    return qtab.train("CliffWalking-v1", max_episode_steps=100, **SETTINGS)


@pytest.mark.slow
def test_an_animation_has_a_picture_of_each_snapshot_in_every_format(cliff: qtab.Run, tmp_path: Path) -> None:
    import imageio_ffmpeg  # type: ignore[import-untyped]

    animation = qtab.animate(cliff, tmp_path / "learning.gif", title="Cliff")
    assert repr(animation) == "<Animation of the values of CliffWalking-v1, 3 pictures>"
    assert len(animation) == 3
    assert animation.episodes.tolist() == [1, 20, 60]
    with Image.open(tmp_path / "learning.gif") as gif:
        assert gif.n_frames == 3
        assert gif.size == animation.frames.size
        assert gif.info["duration"] == 200
        pictures = []
        for index in range(3):
            gif.seek(index)
            pictures.append(np.asarray(gif.convert("RGB")))
    assert all((one != other).any() for one, other in pairwise(pictures))
    assert pictures[0][0, 0].tolist() == [255, 255, 255]  # white stays white
    animation.save(tmp_path / "learning.mp4")
    assert imageio_ffmpeg.count_frames_and_secs(str(tmp_path / "learning.mp4"))[0] == 3
    animation.save(tmp_path / "learning.html")
    text = (tmp_path / "learning.html").read_text()
    labels = ["after 1 episode", "after 20 episodes", "after 60 episodes"]
    assert re.findall(r'data-label="([^"]*)"', text) == labels
    assert '<input type="range" min="0" max="2" step="1" value="2"' in text
    assert animation._repr_html_() in text
    assert_same_run(cliff, qtab.train("CliffWalking-v1", max_episode_steps=100, **SETTINGS))


def test_one_scale_of_colors_holds_for_all_pictures(cliff: qtab.Run) -> None:
    """A value that does not change keeps its color, whatever the others do."""
    snapshots = cliff.snapshots
    assert snapshots is not None
    tables = np.full_like(snapshots.tables, -1.0)
    tables[0, 0, 0], tables[1, 0, 0] = -50.0, 30.0
    run = qtab.Run(**{**vars(cliff), "snapshots": qtab.Snapshots(snapshots.episodes[:2], tables[:2])})
    first, last = draw_learning(runs_at_snapshots(run), ["values"], 5.0)
    height, width, _ = first.shape
    cell = first[height // 2, width // 2]
    assert cell.tolist() == last[height // 2, width // 2].tolist()
    assert (first != last).any()
    bar = slice(int(0.85 * width), width)
    assert (first[:, bar] == last[:, bar]).all()


@pytest.mark.parametrize(("env", "what"), [("MountainCar-v0", "policy"), ("Blackjack-v1", "values")])
def test_nothing_of_an_earlier_picture_is_left(env: str, what: str) -> None:
    run = qtab.train(env, seed=0, episodes=40, max_episode_steps=50, snapshots=2)
    early, late = runs_at_snapshots(run)
    first, between, again = draw_learning([late, early, late], [what], 5.0)
    assert np.array_equal(first, again)
    assert not np.array_equal(first, between)


PLAIN = qtab.train("FrozenLake-v1", episodes=5, seed=0)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({}, r"run must have snapshots: qtab.train\(..., snapshots=50\) keeps them"),
        ({"run": "run.npz"}, "run must be a Run, got 'run.npz'; qtab.load reads one"),
        ({"what": "value"}, r"what must be one of 'values', 'policy', got 'value' \(did you mean 'values'\?\)"),
        ({"fps": 0}, "fps must lie in"),
        ({"title": 3}, "title must be a str, got 3"),
        ({"path": "learning.png"}, "path must end in one of .mp4, .gif, .html, got 'learning.png'"),
        ({"path": "none/learning.gif"}, "path must be a file that can be written"),
    ],
)
def test_wrong_arguments_are_refused(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises((TypeError, ValueError, OSError), match=message):
        qtab.animate(**{"run": PLAIN, **arguments})
