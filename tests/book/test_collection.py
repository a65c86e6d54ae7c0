"""``qtab.book.run_all``: every experiment in a folder, and what is missing after an interruption."""

import json

import pytest

import qtab
from qtab.book import collection

NAMES = ("example-6.5", "figure-6.5")


@pytest.fixture(autouse=True)
def two_experiments(monkeypatch):
    monkeypatch.setattr(collection, "EXPERIMENTS", {name: qtab.book.EXPERIMENTS[name] for name in NAMES})


def files(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def run(folder, **arguments):
    """Returns the experiments that were run, and those that were left out."""
    started = []
    qtab.book.run_all(
        folder, 1, progress=False, on_start=lambda one, done: started.append((one.name, done)), **arguments
    )
    return [name for name, done in started if not done], [name for name, done in started if done]


def test_each_experiment_has_a_table_its_points_and_a_picture(tmp_path):
    folder = tmp_path / "new" / "figures"
    assert run(folder) == ([*NAMES], [])
    written = files(folder)
    assert sorted(written) == sorted(
        ["book.json", *(name + suffix for name in NAMES for suffix in collection.SUFFIXES)]
    )
    assert written["figure-6.5.txt"].decode().startswith("Figure 6.5: ")
    assert written["figure-6.5.png"].startswith(b"\x89PNG")
    result = qtab.book.run("figure-6.5", runs=1)
    result.save(tmp_path / "points.csv")
    assert written["figure-6.5.csv"] == (tmp_path / "points.csv").read_bytes()


@pytest.mark.slow
def test_only_what_is_missing_is_run_again(tmp_path, monkeypatch):
    def interrupt(*_arguments, **_settings):
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(type(qtab.book.find("figure-6.5")), "run", interrupted_at(NAMES[1], interrupt))
        with pytest.raises(KeyboardInterrupt):
            run(tmp_path)
    before = files(tmp_path)
    assert "figure-6.5.txt" not in before
    assert run(tmp_path) == ([NAMES[1]], [NAMES[0]])
    assert files(tmp_path)["example-6.5.txt"] == before["example-6.5.txt"]
    assert run(tmp_path) == ([], [*NAMES])
    (tmp_path / "example-6.5.png").unlink()
    assert run(tmp_path) == ([NAMES[0]], [NAMES[1]])
    assert run(tmp_path, seed=1) == ([*NAMES], [])


def interrupted_at(name, interrupt):
    """``run`` of an experiment, except for one of them."""
    complete = type(qtab.book.find(name)).run

    def run_or_interrupt(self, *arguments, **settings):
        return interrupt() if self.name == name else complete(self, *arguments, **settings)

    return run_or_interrupt


def test_an_experiment_is_run_again_after_its_code_was_edited(tmp_path, monkeypatch):
    sources, folder = tmp_path / "sources", tmp_path / "figures"
    (sources / "figures").mkdir(parents=True)
    edited = sources / "figures" / "figure_6_5.py"
    edited.write_text("STEPS = 1")
    monkeypatch.setattr(collection, "SOURCES", sources)
    monkeypatch.setattr(collection, "EXPERIMENTS", {NAMES[1]: qtab.book.EXPERIMENTS[NAMES[1]]})
    assert run(folder) == ([NAMES[1]], [])
    assert run(folder) == ([], [NAMES[1]])
    edited.write_text("STEPS = 2")
    assert run(folder) == ([NAMES[1]], [])


@pytest.mark.parametrize("content", ["", "[]", "{", json.dumps({"figure-6.5": 3})])
def test_a_record_that_cannot_be_read_counts_as_none(content, tmp_path):
    (tmp_path / "book.json").write_text(content)
    assert run(tmp_path) == ([*NAMES], [])


def test_bad_arguments_are_refused_before_a_folder_is_made(tmp_path):
    for arguments, error in (({"runs": 0}, ValueError), ({"seed": "first"}, TypeError), ({"threads": 0}, ValueError)):
        with pytest.raises(error):
            qtab.book.run_all(tmp_path / "figures", **arguments)
    with pytest.raises(TypeError, match="folder must be a path, got 3"):
        qtab.book.run_all(3)  # type: ignore[arg-type]
    assert not (tmp_path / "figures").exists()
