"""Where features meet: a random run on a random environment goes through the public calls, and what must agree is
compared. More examples: ``--hypothesis-profile fuzz``.
"""

import json
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import gymnasium as gym
import matplotlib.pyplot as plt
import numpy as np
import pytest
from gymnasium.vector.utils import concatenate, create_empty_array
from hypothesis import event, given
from hypothesis import strategies as st

import qtab
from qtab.config.config import DEFAULTS
from support.environments.meetings import CASES, Case, meetings
from support.parity import assert_same_run

ARGUMENTS = {
    *DEFAULTS,
    "run",
    "runs",
    "env",
    "seeds",
    "episodes",
    "episode",
    "step",
    "state",
    "grid",
    "observation",
    "this",
}
"""What the message of a refusal may name first; "this run cannot be written" names the run."""


class Refused(Exception):  # noqa: N818 - not an error
    """A call was refused as it should be: by a message that names an argument."""


@contextmanager
def allowing_refusal() -> Iterator[None]:
    """Turns a refusal that names an argument into :class:`Refused`; any other exception is a failure."""
    try:
        yield
    except (TypeError, ValueError) as error:
        first = re.match(r"[a-z_]+", str(error))
        if first is None or first.group() not in ARGUMENTS:
            raise
        raise Refused(str(error)) from error


def played(case: Case, run: qtab.Run, seed: int) -> tuple[list[float], list[Any], list[Any]]:
    """Plays two episodes by ``predict``, as a user would.

    Returns the return of each episode; each observation, with the state of the policy and the mask; and each action.
    """
    env = gym.wrappers.TimeLimit(case.env(), run.config.max_episode_steps or 0)
    returns, seen = [], []
    for first in (True, False):
        observation, info = env.reset(seed=seed if first else None)
        total, over, state = 0.0, False, None
        while not over:
            masks = info.get("action_mask") if run.config.action_mask is True else None
            seen.append((observation, state, masks))
            action, state = run.predict(observation, state, action_masks=masks)
            observation, reward, terminated, truncated, info = env.step(action)
            total, over = total + float(reward), terminated or truncated
        returns.append(total)
    return returns, seen, [run.predict(one, state, action_masks=masks)[0] for one, state, masks in seen]


def check_evaluation(case: Case, run: qtab.Run, folder: Path) -> None:
    returns, seen, actions = played(case, run, 5)
    evaluation = qtab.evaluate(run, episodes=2, seed=5, **case.again())
    assert evaluation.returns.tolist() == returns
    space: Any = case.env().observation_space
    room: Any = create_empty_array(space, len(seen))
    observations = [observation for observation, _, _ in seen]
    batch = concatenate(space, observations, room)
    steps = [0 if state is None else int(state) for _, state, _ in seen] if run.config.time_aware else None
    masks = None if seen[0][2] is None else np.array([mask for _, _, mask in seen])
    together, _ = run.predict(batch, steps, action_masks=masks)
    assert np.array_equal(np.asarray(together), np.asarray(actions))


def functions_of(run: qtab.Run) -> dict[str, Any]:
    """The functions of a run's config, which its file does not hold."""
    return {"action_mask": run.config.action_mask} if callable(run.config.action_mask) else {}


def check_file(case: Case, run: qtab.Run, folder: Path) -> None:
    run.save(folder / "run.npz")
    loaded = qtab.load(folder / "run.npz", **functions_of(run))
    assert_same_run(run, loaded)
    assert loaded.config == run.config
    check_evaluation(case, loaded, folder)


def check_resumed(case: Case, run: qtab.Run, folder: Path) -> None:
    stopped = qtab.train(case.make(), config=run.config, callback=lambda progress: False, callback_every=1)
    assert len(stopped.episode_returns) == 1
    stopped.save(folder / "stopped.npz")
    for part in (stopped, qtab.load(folder / "stopped.npz", **functions_of(run))):
        assert_same_run(run, qtab.resume(part, **case.again()))


def check_repeated(case: Case, run: qtab.Run, folder: Path) -> None:
    assert_same_run(run, qtab.train(config=run.config, **case.again()))
    assert qtab.verify(run, **case.again()).equal
    if run.config.backend == "rust":
        assert_same_run(run, qtab.train(case.make(), config=run.config.replace(backend="gymnasium")))


def check_explained(case: Case, run: qtab.Run, folder: Path) -> None:
    episode = len(run.episode_returns) - 1
    explanation = qtab.explain(run, episode, steps=3, **case.again())
    assert explanation.episode_return == run.episode_returns[episode]
    assert explanation.episode_length == run.episode_lengths[episode]
    assert str(explanation)


def check_diagnosed(case: Case, run: qtab.Run, folder: Path) -> None:
    diagnosis = qtab.diagnose(run, seeds=2)
    assert str(diagnosis)


def check_pictures(case: Case, run: qtab.Run, folder: Path) -> None:
    for draw in (qtab.plot, qtab.plots.values, qtab.plots.policy, qtab.plots.schedule, qtab.plots.visits):
        try:
            with allowing_refusal():
                draw(run)
        except Refused as refusal:
            event(f"{draw.__name__} refused: {str(refusal)[:60]}")
        finally:
            plt.close("all")


def check_export(case: Case, run: qtab.Run, folder: Path) -> None:
    try:
        with allowing_refusal():
            run.to_json(folder / "run.json")
    except Refused as refusal:
        event(f"to_json refused: {str(refusal)[:60]}")
    else:
        assert json.loads((folder / "run.json").read_text())["env"] == run.config.env


def check_step(case: Case, run: qtab.Run, folder: Path) -> None:
    observation, info = case.env().reset(seed=1)
    masks = info.get("action_mask") if run.config.action_mask is True else None
    at_start, _ = run.at_step(0).predict(observation, action_masks=masks)
    assert np.array_equal(at_start, run.predict(observation, action_masks=masks)[0])


def check_many(case: Case, run: qtab.Run, folder: Path) -> None:
    if run.config.backend != "rust" or not isinstance(case.make(), str):
        return
    runs = qtab.train_many(
        case.make(), [(run.config.seed or 0) ^ 1, run.config.seed or 0], config=run.config, tables=True, threads=2
    )
    assert_same_run(run, runs[1])
    sweep = qtab.sweep(
        case.make(), {"discount": [run.config.discount]}, seeds=[run.config.seed or 0], config=run.config
    )
    assert sweep.values("final_return", 0)[0] == runs.final_returns(min(100, run.config.episodes))[1]


CHECKS: list[Callable[[Case, qtab.Run, Path], None]] = [
    check_evaluation,
    check_file,
    check_resumed,
    check_repeated,
    check_explained,
    check_diagnosed,
    check_pictures,
    check_export,
    check_step,
    check_many,
]


@pytest.mark.parametrize("name", CASES)
def test_every_environment_trains(name: str) -> None:
    case = CASES[name]
    bins: dict[str, Any] = {"discretizer": "bins", "bins": 2} if case.kind == "box" else {}
    for settings in case.settings:
        run = qtab.train(case.make(), episodes=2, max_episode_steps=4, seed=0, **bins, **settings)
        assert run.completed


@pytest.mark.slow
@given(meetings(), st.lists(st.sampled_from(CHECKS), min_size=2, max_size=4, unique=True), st.booleans())
def test_what_must_agree_agrees(
    tmp_path_factory: pytest.TempPathFactory,
    drawn: tuple[Case, dict[str, Any]],
    checks: list[Callable[[Case, qtab.Run, Path], None]],
    visits: bool,
) -> None:
    case, chosen = drawn
    try:
        with allowing_refusal():
            run = qtab.train(case.make(), visits=visits, **chosen)
    except Refused as refusal:
        event(f"train refused: {str(refusal)[:60]}")
        return
    for check in checks:
        check(case, run, tmp_path_factory.mktemp("meeting"))
