"""Output whose encoding lacks Greek letters, as that of a pipe on Windows."""

import io
import sys

import pytest

import qtab
from qtab.cli import main


@pytest.mark.parametrize("encoding", ["cp1252", "ascii"])
def test_letters_that_an_encoding_lacks_are_written_as_words(tmp_path, monkeypatch, encoding):
    path = tmp_path / "run.npz"
    qtab.train("MountainCar-v0", seed=0, episodes=5).save(path)
    outputs = {}
    for name in (encoding, "utf-8"):
        stream = io.TextIOWrapper(io.BytesIO(), encoding=name)
        monkeypatch.setattr(sys, "stdout", stream)
        assert main(["explain", str(path), "--episode", "1", "--steps", "1"]) == 0
        stream.flush()
        outputs[name] = stream.buffer.getvalue().decode(name)
    assert "γ max" in outputs["utf-8"]
    assert "gamma max" in outputs[encoding]
    assert "?" not in outputs[encoding]


def test_the_help_can_be_read_in_ascii(monkeypatch):
    stream = io.TextIOWrapper(io.BytesIO(), encoding="ascii")
    monkeypatch.setattr(sys, "stdout", stream)
    with pytest.raises(SystemExit):
        main(["train", "--help"])
    stream.flush()
    text = stream.buffer.getvalue().decode("ascii")
    assert "--learning-rate" in text
    assert "kappa sqrt tau" in text
    assert "?" not in text
