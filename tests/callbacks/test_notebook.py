"""In a notebook figures, the learning curve and the progress bars are shown; elsewhere no curve and no bar is."""

import io
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import qtab
from qtab._utils.progress import ProgressBar, in_notebook
from qtab.callbacks import LivePlot, StopAtReturn, live_plot
from support.parity import assert_same_run

SHORT: dict[str, Any] = {"seed": 6, "episodes": 300, "max_episode_steps": 30}


class Screen:
    """What a notebook shows: pictures, each of which can be replaced."""

    def __init__(self) -> None:
        self.shown: list[bytes] = []
        self.replaced: list[bytes] = []

    def display(self, image: Any, display_id: bool) -> "Screen":
        self.shown.append(image.data)
        return self

    def update(self, image: Any) -> None:
        self.replaced.append(image.data)


@pytest.fixture
def screen(monkeypatch: pytest.MonkeyPatch) -> Screen:
    import IPython.display

    screen = Screen()
    monkeypatch.setattr(live_plot, "in_notebook", lambda: True)
    monkeypatch.setattr(live_plot, "DOTS_PER_INCH", 30)  # small pictures are drawn faster
    monkeypatch.setattr(IPython.display, "display", screen.display)
    return screen


def pixels(picture: bytes) -> np.ndarray:
    from PIL import Image

    return np.array(Image.open(io.BytesIO(picture)).convert("RGB"))


def test_one_picture_is_replaced_in_place(screen: Screen) -> None:
    run = qtab.train("MountainCar-v0", callback=LivePlot(seconds=0), **SHORT)
    assert_same_run(run, qtab.train("MountainCar-v0", **SHORT))
    assert len(screen.shown) == 1
    assert len(screen.replaced) == 2
    first, last = pixels(screen.shown[0]), pixels(screen.replaced[-1])
    assert first.shape == last.shape
    assert 0.001 < (first != last).mean() < 0.2  # the curve grew, and the axes stayed


@pytest.mark.slow
def test_the_clock_limits_the_pictures_but_the_end_is_always_drawn(screen: Screen) -> None:
    live = LivePlot(1, seconds=1e6)
    qtab.train("MountainCar-v0", callback=live, **SHORT)
    assert (len(screen.shown), len(screen.replaced)) == (1, 1)
    qtab.train("MountainCar-v0", callback=[live, StopAtReturn(-1e9, window=7, every=1)], **SHORT)
    assert (len(screen.shown), len(screen.replaced)) == (2, 2)


def test_a_picture_of_an_interrupted_run_stays_as_it_is(screen: Screen) -> None:
    def interrupt(progress: qtab.Progress) -> None:
        if progress.episodes == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        qtab.train("MountainCar-v0", callback=[interrupt, LivePlot(2, seconds=1e6)], callback_every=1, **SHORT)
    assert (len(screen.shown), len(screen.replaced)) == (1, 0)


def test_outside_of_a_notebook_nothing_is_shown(monkeypatch: pytest.MonkeyPatch, capsys: Any) -> None:
    assert not in_notebook()
    monkeypatch.setitem(sys.modules, "IPython", None)  # cannot be imported
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    qtab.train("MountainCar-v0", callback=LivePlot(seconds=0), **SHORT)
    assert capsys.readouterr() == ("", "")


def test_a_notebook_without_matplotlib_names_the_command_that_installs_it(
    screen: Screen, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(ModuleNotFoundError, match=r"pip install .*matplotlib"):
        qtab.train("MountainCar-v0", callback=LivePlot(), **SHORT)


@pytest.mark.parametrize("seconds", [-1, float("nan"), "1"])
def test_a_wrong_time_is_refused(seconds: Any) -> None:
    with pytest.raises((TypeError, ValueError), match=r"^seconds must "):
        LivePlot(seconds=seconds)


def test_a_bar_appears_by_itself_in_a_notebook_only(monkeypatch: pytest.MonkeyPatch) -> None:
    assert not ProgressBar(3, "run", None).is_shown
    monkeypatch.setattr("qtab._utils.progress.in_notebook", lambda: True)
    with ProgressBar(3, "run", None) as bar:
        assert bar.is_shown
    assert not ProgressBar(3, "run", False).is_shown


def test_without_ipywidgets_a_bar_of_text_comes_without_a_warning(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in [name for name in sys.modules if name.partition(".")[0] in ("tqdm", "ipywidgets")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "ipywidgets", None)  # cannot be imported
    monkeypatch.setitem(sys.modules, "IPython.html.widgets", None)  # where they were before
    monkeypatch.setattr("qtab._utils.progress.in_notebook", lambda: True)
    qtab.evaluate(qtab.train("FrozenLake-v1", seed=0, episodes=5, progress=False), 20, seed=0, progress=True)
    assert "0/20" in capsys.readouterr().err


def test_a_wrong_progress_is_refused_even_where_no_bar_would_come() -> None:
    run = qtab.train("FrozenLake-v1", seed=0, episodes=200)
    sweep = qtab.sweep("FrozenLake-v1", {"discount": [0.9]}, 1, episodes=5)
    wrong: Any = 1
    for call in (
        lambda: qtab.evaluate(run, progress=wrong),
        lambda: qtab.optimum("FrozenLake-v1", progress=wrong),
        lambda: qtab.sweep("FrozenLake-v1", {"discount": [0.9]}, 1, episodes=5, progress=wrong),
        lambda: sweep.confirm(1, progress=wrong),
        lambda: qtab.diagnose(run).what_if(2, progress=wrong),
    ):
        with pytest.raises(TypeError, match=r"^progress must be True, False or None, got 1$"):
            call()


CELLS = {
    "picture": """
import qtab
from qtab.callbacks import LivePlot
run = qtab.train("MountainCar-v0", seed=0, episodes=500, callback=LivePlot(seconds=0), progress=True)
""",
    "train_many": "runs = qtab.train_many('MountainCar-v0', 4, episodes=20, progress=True)",
    "sweep": "sweep = qtab.sweep('FrozenLake-v1', {'discount': [0.9, 1.0]}, 3, episodes=50, progress=True)",
    "confirm": "confirmation = sweep.confirm(7, progress=True)",
    "evaluate": "evaluation = qtab.evaluate(run, 11, progress=True)",
    "optimum": "optimum = qtab.optimum('FrozenLake-v1', progress=True)",
    "what_if": "tried = qtab.diagnose(qtab.train('FrozenLake-v1', seed=0, episodes=300)).what_if(13, progress=True)",
    "book": "result = qtab.book.run('example-6.5', runs=17, progress=True)",
    "stopped": "run = qtab.train('MountainCar-v0', episodes=19, callback=lambda p: False, progress=True)",
}
TOTALS = {500: 500, 4: 4, 6: 6, 7: 7, 11: 11, 1: 1, 26: 26, 34: 34}
"""The number of units of each bar, and how many of them are done at its end."""


FIGURES = [
    "run = qtab.train('FrozenLake-v1', seed=0, episodes=20)\nbest = qtab.optimum('FrozenLake-v1')",
    "qtab.plot(run)",
    "ax = qtab.plots.distribution([1.0, 2.0, 4.0])",
    "qtab.book.run('example-6.5', runs=2).plot()",
    "qtab.plots.overview(run)",
    "figure = qtab.plot(run).figure",
    "display(figure)",
    "ax = qtab.plots.values([run, best])\nax.figure",
]
"""Each but the first shows one figure."""


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # of Jupyter's libraries
def test_a_kernel_shows_every_figure_once_and_a_widget_for_every_long_call(tmp_path: Path) -> None:
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    pytest.importorskip("ipywidgets")
    # One kernel for both, as it takes seconds to start.
    cells = [nbformat.v4.new_code_cell(cell) for cell in (*CELLS.values(), *FIGURES)]
    # The kernel chooses its own backend, as it does for a user.
    with pytest.MonkeyPatch.context() as environment:
        environment.delenv("MPLBACKEND", raising=False)
        environment.setenv("IPYTHONDIR", str(tmp_path))
        client = nbclient.NotebookClient(
            nbformat.v4.new_notebook(cells=cells), timeout=600, startup_timeout=600, kernel_name="python3"
        )
        done = client.execute(cwd=str(tmp_path))
    pictures = [sum("image/png" in output.get("data", {}) for output in cell.outputs) for cell in done.cells]
    assert pictures == [1] + [0] * len(CELLS) + [1] * (len(FIGURES) - 1)
    models = done.metadata.widgets["application/vnd.jupyter.widget-state+json"].state.values()
    bars = [model.state for model in models if model.model_name == "FloatProgressModel"]
    assert {int(bar["max"]): int(bar["value"]) for bar in bars}.items() >= TOTALS.items()
    # Nothing is left of the widgets, which a saved notebook could not show again.
    for name, cell in list(zip(CELLS, done.cells, strict=False))[1:]:
        assert [dict(output.data) for output in cell.outputs] == [{"text/plain": ""}], name
