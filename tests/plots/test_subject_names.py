"""Titles and tables write the names of algorithms as Sutton & Barto do."""

from pathlib import Path
from typing import Any

import pytest

import qtab
from qtab.config.choices import ALGORITHM_NAMES, CHOICES


def test_every_algorithm_has_a_name_of_its_own() -> None:
    assert tuple(ALGORITHM_NAMES) == CHOICES["algorithm"]
    assert len(set(ALGORITHM_NAMES.values())) == len(ALGORITHM_NAMES)


@pytest.mark.parametrize("algorithm", ["true_online_sarsa_lambda", "n_step_sarsa", "dyna_q_plus"])
def test_a_title_has_the_name(algorithm: Any) -> None:
    run = qtab.train("FrozenLake-v1", algorithm=algorithm, discretizer="identity", seed=3, episodes=2)
    title = qtab.plots.values(run).get_title(loc="left")
    assert title == f"FrozenLake-v1: {ALGORITHM_NAMES[algorithm]}, seed 3"


@pytest.mark.slow
def test_the_page_of_a_run_has_the_name(tmp_path: Path) -> None:
    run = qtab.train("FrozenLake-v1", algorithm="watkins_q_lambda", seed=3, episodes=2)
    run.to_html(tmp_path / "run.html", optimum=1.0)
    assert ">Watkins&#x27;s Q(λ)<" in (tmp_path / "run.html").read_text(encoding="utf-8")
