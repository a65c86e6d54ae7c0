"""An explanation is the same whether the reference repeats all episodes or starts from Rust's tables and generators."""

from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given, settings

import qtab
from qtab.explanation import explain as module
from qtab.explanation.fast_forward import Start, start_of
from support.learners.explained_algorithms import STEP_BY_STEP, WITH_TILES
from support.learners.learner_settings import run_settings

CAR = "MountainCar-v0"
ALGORITHMS = (*STEP_BY_STEP, *WITH_TILES)
EXAMPLES = max(1, (settings.default or settings()).max_examples // 20)


def from_the_first_episode(run: qtab.Run, episode: int) -> qtab.Explanation:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "start_of", lambda run, episode: None)
        return qtab.explain(run, episode, steps=100)


def same(one: qtab.Explanation, other: qtab.Explanation) -> bool:
    """Whether all steps are equal; observations are compared as text, for arrays have no single truth."""
    return [repr(step) for step in one.steps] == [repr(step) for step in other.steps]


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_both_ways_give_the_same_steps(algorithm: Any) -> None:
    @settings(max_examples=EXAMPLES, deadline=None)
    @given(run_settings(algorithm))
    def compare(chosen: dict[str, Any]) -> None:
        try:
            run = qtab.train(CAR, **chosen)
        except OverflowError:
            return
        last = len(run.episode_returns) - 1
        assert same(qtab.explain(run, last, steps=100), from_the_first_episode(run, last))

    compare()


@pytest.mark.parametrize("algorithm", [name for name in ALGORITHMS if "dyna" not in name])
@pytest.mark.parametrize("env", [CAR, "FrozenLake-v1"])
def test_the_start_leads_to_the_values_after_the_episode(algorithm: Any, env: str) -> None:
    kinds: list[dict[str, Any]] = [
        {},
        {"exploration": "softmax"},
        {"bit_generator": "MT19937", "on_truncation": "terminate"},
    ]
    for choices in kinds:
        run = qtab.train(env, algorithm=algorithm, seed=1, episodes=20, max_episode_steps=12, **choices)
        start = start_of(run, 19)
        assert start is not None
        repeated = module._repeat(run, 19, None, start, None)
        assert len(repeated.returns) == 1
        assert repeated.agrees_with(start, run)


@pytest.mark.parametrize(
    "chosen",
    [
        {"algorithm": "dyna_q"},
        {"ties": "random"},
        {"learning_rate_schedule": "visits"},
        {"backend": "gymnasium"},
    ],
)
def test_what_only_the_steps_before_tell_is_repeated_from_the_start(chosen: dict[str, Any]) -> None:
    run = qtab.train(CAR, seed=0, episodes=3, max_episode_steps=20, **chosen)
    assert start_of(run, 2) is None
    assert len(qtab.explain(run, 2)) == 5


def test_a_start_that_leads_elsewhere_is_not_believed(monkeypatch: pytest.MonkeyPatch) -> None:
    run = qtab.train(CAR, seed=0, episodes=3, max_episode_steps=20)
    expected = from_the_first_episode(run, 2)

    def wrong(run: qtab.Run, episode: int) -> Start:
        start = start_of(run, episode)
        assert start is not None
        return replace(start, tables=start.tables + 1.0)

    monkeypatch.setattr(module, "start_of", wrong)
    assert same(qtab.explain(run, 2, steps=100), expected)


def test_values_that_never_change_do_not_make_a_new_bandit_problem_the_first_one() -> None:
    run = qtab.train(
        "qtab/KArmedBandit-v0",
        learning_rate=0.0,
        epsilon=0.5,
        ties="first",
        algorithm="sarsa_lambda",
        max_episode_steps=4,
        episodes=4,
        seed=0,
    )
    assert qtab.explain(run, 3).episode_return == run.episode_returns[3]
