"""One definition of "solved": for train's report, diagnoses, what_if, and the thresholds of plots and evaluations."""

import json
import re
from pathlib import Path
from typing import Any

import gymnasium as gym
import pytest
from gymnasium.envs.classic_control import MountainCarEnv

import qtab
from qtab.envs.metadata.goals import reward_threshold, threshold_of
from qtab.training.verdict import judge
from support.processes.command import qtab_here
from support.repository import PACKAGE

LAKE, TAXI, CAR = "FrozenLake-v1", "Taxi-v4", "MountainCar-v0"


@pytest.fixture(scope="module")
def short() -> qtab.Run:
    """A run under a time limit in which the flag cannot be reached."""
    return qtab.train(CAR, preset="solved", max_episode_steps=60, episodes=200, seed=0)


def test_gymnasiums_threshold_holds_for_its_own_time_limit_only(short: qtab.Run) -> None:
    assert short.episode_returns[-100:].mean() == -60.0  # above the threshold
    diagnosis = qtab.diagnose(short)
    assert diagnosis.solved is None
    assert diagnosis.names == ("short time limit",)
    assert "max_episode_steps=200" in diagnosis["short time limit"].advice
    assert "Gymnasium's threshold of -110 holds for 200 steps, not for max_episode_steps=60" in str(diagnosis)
    assert "solved" not in diagnosis.heading.replace("not known whether solved", "")
    assert qtab.evaluate(short, 5, seed=0).success_rate is None
    assert qtab.evaluate(short, 5, seed=0, max_episode_steps=200).success_rate == 0.0
    pytest.importorskip("matplotlib")
    labels = [line.get_label() for line in qtab.plot(short, optimum=-110).get_lines()]
    assert not [label for label in labels if str(label).startswith("threshold")]


@pytest.mark.parametrize(
    ("env", "kwargs", "steps", "threshold"),
    [
        (LAKE, {}, 100, 0.7),
        (LAKE, {"map_name": "4x4", "is_slippery": True, "render_mode": None}, 100, 0.7),
        (LAKE, {"map_name": "4x4", "is_slippery": False}, 100, None),
        (LAKE, {"map_name": "8x8"}, 100, None),
        (LAKE, {}, 99, None),
        (CAR, {"goal_velocity": 0}, 200, -110.0),
        (CAR, {"goal_velocity": 0.01}, 200, None),
        (f"qtab/{CAR}", {}, 200, -110.0),
        (f"qtab/{CAR}", {}, 1000, None),
        ("CartPole-v1", {"sutton_barto_reward": True}, 500, None),
        ("CliffWalking-v1", {}, 10_000, None),
        ("NoSuch-v0", {}, 10, None),
    ],
)
def test_the_threshold_is_that_of_the_environment_as_registered(
    env: str, kwargs: dict[str, Any], steps: int, threshold: float | None
) -> None:
    assert reward_threshold(env, kwargs, steps) == threshold


def _changed(env: str, *names: str) -> gym.Env:
    made: Any = gym.make(env)
    for name in names:
        setattr(made.unwrapped, name, 2 * getattr(made.unwrapped, name))
    return made


def _with_method(env: str) -> gym.Env:
    made: Any = gym.make(env)
    made.unwrapped.step = made.unwrapped.step
    return made


def _with_other_table() -> gym.Env:
    made: Any = gym.make(LAKE)
    made.unwrapped.P[0][0] = [(1.0, 15, 1.0, True)]
    return made


class Easier(MountainCarEnv):
    """Moves the goal."""

    def step(self, action: int) -> Any:
        observation, reward, _, truncated, info = super().step(action)
        return observation, reward, bool(observation[0] > -0.4), truncated, info


def _of_another_class() -> gym.Env:
    made: Any = gym.make(CAR)
    made.unwrapped.__class__ = Easier
    return made


CHANGED: list[tuple[Any, str | None]] = [
    (lambda: _changed(CAR, "force"), "its attribute force was changed"),
    (lambda: _changed(CAR, "gravity", "force"), "its attribute force was changed"),
    (_with_other_table, "its transition table was changed"),
    (lambda: _with_method(LAKE), "its attribute step was changed"),
    (_of_another_class, "the code of its class is different"),
    (
        lambda: gym.wrappers.TransformReward(gym.make(LAKE), lambda reward: 10 * float(reward)),
        "it has the wrapper TransformReward",
    ),
    (
        lambda: gym.wrappers.ClipReward(
            gym.wrappers.TransformReward(gym.make(LAKE), lambda reward: 10 * float(reward)), 0, 5
        ),
        "it has the wrappers ClipReward, TransformReward",
    ),
    (lambda: gym.Wrapper(gym.make(LAKE)), "it has the wrapper Wrapper"),
    (lambda: gym.wrappers.StickyAction(gym.make(CAR), 0.5), "it has the wrapper StickyAction"),
    (lambda: gym.wrappers.RecordEpisodeStatistics(gym.make(LAKE)), None),
    (lambda: gym.wrappers.TransformObservation(gym.make(LAKE), lambda n: 15 - n, None), None),
    (lambda: gym.wrappers.TransformAction(gym.make(CAR), lambda a: 2 - a, None), None),
    (lambda: gym.make(CAR), None),
    (lambda: gym.make(f"qtab/{CAR}"), None),
]


@pytest.mark.parametrize(("make", "reason"), CHANGED)
def test_no_threshold_holds_where_the_environment_was_changed(make: Any, reason: str | None, tmp_path: Path) -> None:
    env = make()
    run = qtab.train(env, episodes=2, seed=0)
    run.save(tmp_path / "run.npz")
    registered = gym.spec(env.spec.id).reward_threshold
    for found in (run, qtab.load(tmp_path / "run.npz")):
        verdict = judge(found, None)
        assert threshold_of(found.config) == verdict.goal.threshold == (registered if reason is None else None)
        if reason is not None:
            assert verdict.solved is None
            assert verdict.why_unknown == (
                f"Gymnasium's threshold of {registered:g} does not hold for the returns of this environment: {reason}, "
                "and no optimum is known"
            )
    assert qtab.evaluate(run, 1, seed=0, env=env).reward_threshold == threshold_of(run.config)


def test_no_threshold_holds_where_a_method_of_gymnasiums_class_was_replaced(monkeypatch: pytest.MonkeyPatch) -> None:
    original: Any = MountainCarEnv.step
    monkeypatch.setattr(MountainCarEnv, "step", lambda *given: original(*given))
    run = qtab.train(gym.make(CAR), episodes=1, seed=0)  # any other environment made now has that method as well
    assert threshold_of(run.config) is None
    assert "methods of its class MountainCarEnv were replaced" in judge(run, None).why_unknown


def test_the_optimum_of_a_changed_table_has_no_threshold() -> None:
    assert qtab.optimum(gym.make(LAKE)).reward_threshold == 0.7
    assert qtab.optimum(_with_other_table()).reward_threshold is None


@pytest.mark.parametrize(
    ("arguments", "solved", "sentence"),
    [
        (
            [LAKE, "--learning-rate", "0.8", "--discount", "0.95"],
            True,
            r"the last 100 training episodes 0\.54; greedy policy 0\.7402, threshold 0\.7",
        ),
        (
            [TAXI],
            True,
            r"the last 100 training episodes 7\.58; greedy policy 7\.877, threshold 8, above the optimum 7\.93: 7\.771 "
            "or more counts as solved",
        ),
        (
            [LAKE, "--epsilon", "0", "--episodes", "300"],
            False,
            r"the last 100 training episodes 0; greedy policy 0, threshold 0\.7",
        ),
        (
            ["CliffWalking-v1", "--preset", "solved"],
            True,
            r"the last 100 training episodes -13; greedy policy -13, optimum -13: -13\.26 or more counts as solved",
        ),
        (
            [CAR, "--episodes", "50"],
            False,
            r"the last 50 training episodes -200; greedy policy -200 over 100 episodes, threshold -110",
        ),
        ([CAR, "--preset", "solved", "--max-episode-steps", "60", "--episodes", "150"], None, ""),
        (["Pendulum-v1", "--episodes", "120"], None, ""),
    ],
)
def test_train_and_diagnose_agree(tmp_path: Path, arguments: list[str], solved: bool | None, sentence: str) -> None:
    flags = ["train", *arguments, "--seed", "0", "--save", "run.npz"]
    content = json.loads(qtab_here(*flags, "--json", cwd=tmp_path).stdout)
    diagnosis = qtab.diagnose(qtab.load(tmp_path / "run.npz"), seeds=0)
    assert content["solved"] is diagnosis.solved is solved
    assert {name: content[name] for name in diagnosis.verdict.numbers()} == diagnosis.verdict.numbers()
    assert re.fullmatch(sentence or ".*", str(diagnosis.verdict))
    text = qtab_here(*flags[:-2], cwd=tmp_path).stdout
    line = {True: "Solved: ", False: "Not solved: "}
    if solved is not None:
        assert f"\n{line[solved]}{diagnosis.verdict}" in text
    assert ("\nSolved" in text) == (solved is True)


def test_a_goal_that_only_a_count_of_the_steps_reaches_is_not_asked_of_others() -> None:
    run = qtab.train(LAKE, preset="solved", seed=0, max_episode_steps=15)
    best = qtab.optimum(run)
    assert best.stationary is not None
    assert best.expected_return > best.stationary.expected_return + 0.002
    verdict = judge(run, best)
    assert verdict.goal.threshold is None
    assert verdict.goal.best == best.stationary.expected_return
    assert str(verdict.goal).startswith("best return without a count of the steps 0.")
    assert judge(qtab.train(LAKE, preset="time_aware", seed=0, max_episode_steps=15), best).goal.best == (
        best.expected_return
    )


def test_fewer_than_a_hundred_episodes_do_not_count_by_themselves() -> None:
    room = qtab.train("CartPole-v1", seed=0, episodes=99, backend="gymnasium")
    verdict = judge(room, None)
    assert (verdict.solved, verdict.greedy_return) == (None, None)
    assert verdict.why_unknown == "there are fewer than 100 training episodes"


def test_what_if_counts_by_the_same_definition() -> None:
    run = qtab.train(LAKE, seed=0, learning_rate=1.0, episodes=3000)
    diagnosis = qtab.diagnose(run, seeds=0)
    for trial in diagnosis.what_if(3).results:
        if "preset" not in trial.change:
            runs = qtab.train_many(config=run.config, seeds=3, tables=True, **trial.change)
            solved = [judge(one, diagnosis.facts.optimum).solved for one in runs]
            assert trial.solved == solved.count(True)
            assert trial.solved > (runs.final_returns() >= 0.7).sum()  # exploration costs some of these


def test_only_one_function_reads_the_threshold_of_a_spec() -> None:
    # The second registers environments with it; the third describes those of the page, which cannot be changed.
    allowed = {"envs/metadata/goals.py", "envs/__init__.py", "playground/definitions.py"}
    reading = {
        path.relative_to(PACKAGE).as_posix()
        for path in PACKAGE.rglob("*.py")
        if re.search(r"(spec|known|registered)\w*\.reward_threshold", path.read_text(encoding="utf-8"))
    }
    assert reading == allowed
