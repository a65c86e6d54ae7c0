"""A bar counts the episodes of all runs, whoever steps the environment, and changes no number."""

from typing import Any

import pytest

import qtab
from support.environments import Chain

CALLS: dict[str, tuple[Any, Any, dict[str, Any]]] = {
    "in Rust, two threads": ("qtab/RandomWalk-v0", "random", {"episodes": 60, "seeds": 3, "threads": 2}),
    "a policy in Python": (
        "MountainCar-v0",
        lambda observation: 0 if observation[1] < 0 else 2,
        {"episodes": 3, "seeds": 2, "discretizer": "bins"},
    ),
    "an environment in Python": (Chain(), "random", {"episodes": 40, "scale": (4,)}),
}
TOTALS = {"in Rust, two threads": 180, "a policy in Python": 6, "an environment in Python": 40}


@pytest.mark.parametrize("call", CALLS)
def test_a_bar_counts_the_episodes_and_changes_no_number(call: str, capsys: pytest.CaptureFixture[str]) -> None:
    env, policy, settings = CALLS[call]
    shown = qtab.estimate_values(env, policy, progress=True, **settings)
    assert f"/{TOTALS[call]} [" in capsys.readouterr().err
    hidden = qtab.estimate_values(env, policy, progress=False, **settings)
    unasked = qtab.estimate_values(env, policy, **settings)
    assert capsys.readouterr() == ("", "")
    assert shown.weights.tobytes() == hidden.weights.tobytes() == unasked.weights.tobytes()


def test_the_bar_moves_while_the_runs_go_on(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[int] = []
    monkeypatch.setattr("qtab._utils.progress.ProgressBar.move_to", lambda bar, done: seen.append(done))
    qtab.estimate_values("qtab/RandomWalk-v0", "random", episodes=60_000, record=60_000, threads=1, progress=True)
    assert seen == sorted(seen)
    assert 0 < seen[len(seen) // 2] < seen[-1] == 60_000


def test_an_exception_of_the_bar_ends_the_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(bar: Any, done: int) -> None:
        raise OSError("the terminal is gone")

    monkeypatch.setattr("qtab._utils.progress.ProgressBar.move_to", fail)
    cases: tuple[tuple[Any, dict[str, Any]], ...] = (("qtab/RandomWalk-v0", {}), (Chain(), {"scale": (4,)}))
    for env, settings in cases:
        with pytest.raises(OSError, match="the terminal is gone"):
            qtab.estimate_values(env, "random", episodes=10**7, record=10**7, progress=True, **settings)


def test_a_wrong_progress_is_refused() -> None:
    wrong: Any = 1
    with pytest.raises(TypeError, match=r"^progress must be True, False or None, got 1$"):
        qtab.estimate_values("qtab/RandomWalk-v0", "random", progress=wrong)
