"""An explanation's numbers are the run's: from the shown targets and step sizes follows the table, bit for bit."""

from dataclasses import replace
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from hypothesis import given, settings
from numpy.typing import NDArray

import qtab
from qtab.explanation.records import ExplainedStep, Update
from support.environments.gridworld import Room
from support.learners.explained_algorithms import STEP_BY_STEP
from support.learners.learner_settings import run_settings

CAR = "MountainCar-v0"
ALGORITHMS = STEP_BY_STEP
EXAMPLES = max(1, (settings.default or settings()).max_examples // 20)
TRACED = "sarsa_lambda", "true_online_sarsa_lambda", "watkins_q_lambda"
SMALL: dict[str, Any] = {"seed": 3, "episodes": 6, "max_episode_steps": 60, "epsilon": 0.5}


def target(update: Update, discount: float) -> float:
    """The target from the rewards and the value of what follows, in the order of the book's sum."""
    if len(update.rewards) == 1:
        return update.rewards[0] if update.bootstrap is None else update.rewards[0] + discount * update.bootstrap
    total, factor = 0.0, 1.0
    for reward in update.rewards:
        total += factor * reward
        factor *= discount
    return total if update.bootstrap is None else total + factor * update.bootstrap


def apply(update: Update, table: NDArray[np.float64]) -> None:
    """Changes the values of S and A as the shown numbers say."""
    rows, action = update.rows, update.action
    assert update.weights_before == tuple(table[list(rows), action])
    if update.assigned:
        table[rows[0], action] = update.target
    elif not update.traces:
        error = update.target - update.before
        for row, size in zip(rows, update.step_sizes, strict=True):
            table[row, action] += size * error
    else:
        old = update.before if update.old_value is None else update.old_value
        error = update.target - update.before
        if update.old_value is not None:
            error += update.before - old
        for row, (size, trace) in dict(
            zip(rows, zip(update.step_sizes, update.traces, strict=True), strict=True)
        ).items():
            if trace != 0.0:
                table[row, action] += size * error * trace
        if update.old_value is not None:
            for row, size in zip(rows, update.step_sizes, strict=True):
                table[row, action] -= size * (update.before - old)
    assert update.weights_after == tuple(table[list(rows), action])


def check(steps: tuple[ExplainedStep, ...], discount: float, tables: NDArray[np.float64], traced: bool) -> None:
    """Follows the steps of an episode from the tables before it, to those after it."""
    for step in steps:
        for update in (*step.updates, *step.planning):
            assert update.target == target(update, discount)
            assert update.error == update.target - update.before
            apply(update, tables[update.table])
        if traced:  # the other values that changed
            assert step.n_traces == len(step.traces) or len(step.traces) == 8
            for trace in step.traces:
                assert trace.row in step.rows or trace.before == tables[0][trace.row, trace.action]
                tables[0][trace.row, trace.action] = trace.after


def last_episode(run: qtab.Run) -> tuple[qtab.Explanation, NDArray[np.float64]]:
    """The explanation of all steps of the last episode, and the tables before it."""
    episode = len(run.episode_returns) - 1
    before = qtab.train(
        config=run.config, callback=lambda progress: progress.episodes < episode, callback_every=episode
    )
    explanation = qtab.explain(run, episode, steps=10_000)
    assert len(explanation) == run.episode_lengths[episode]
    return explanation, before.tables.copy()


@pytest.mark.parametrize("discretizer", ["round", "tiles"])
@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_the_numbers_of_an_episode_give_the_table_after_it(algorithm: Any, discretizer: Any) -> None:
    if "dyna" in algorithm:
        discretizer = "round"
    # So few tilings, and traces that are cut off so soon, that all of them are shown.
    options: dict[str, Any] = {"trace_decay": 0.3, "trace_cutoff": 0.2} if algorithm in TRACED else {}
    options |= {"tilings": 2} if discretizer == "tiles" else {}
    run = qtab.train(CAR, algorithm=algorithm, discretizer=discretizer, **options, **SMALL)
    explanation, tables = last_episode(run)
    check(explanation.steps, run.config.discount, tables, algorithm in TRACED)
    assert all(step.n_traces == len(step.traces) for step in explanation.steps)
    assert tables.tobytes() == run.tables.tobytes()
    assert sum(len(step.updates) for step in explanation.steps) == len(explanation)


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_random_settings_are_explained_to_the_bit(algorithm: Any) -> None:
    @settings(max_examples=EXAMPLES, deadline=None)
    @given(run_settings(algorithm))
    def follow(chosen: dict[str, Any]) -> None:
        try:
            run = qtab.train(CAR, **chosen)
        except OverflowError:
            return
        explanation, tables = last_episode(run)
        traced = algorithm in TRACED
        if not traced or all(step.n_traces == len(step.traces) for step in explanation.steps):
            check(explanation.steps, run.config.discount, tables, traced)
            assert tables.tobytes() == run.tables.tobytes()
        assert str(explanation)

    follow()


@pytest.mark.parametrize("algorithm", ALGORITHMS)
@pytest.mark.parametrize("on_truncation", ["bootstrap", "terminate"])
def test_terminal_and_truncated_steps_have_their_targets(algorithm: Any, on_truncation: Any) -> None:
    run = qtab.train(
        "FrozenLake-v1", algorithm=algorithm, seed=0, episodes=60, max_episode_steps=7, on_truncation=on_truncation
    )
    assert run.terminated.any()
    assert not run.terminated.all()
    for over in (True, False):
        episode = int(np.flatnonzero(run.terminated == over)[0])
        last = qtab.explain(run, episode, steps=100)[-1]
        assert last.terminated == over
        assert last.truncated or over
        assert (last.updates[-1].bootstrap is None) == (over or on_truncation == "terminate")
    assert "time limit" in str(qtab.explain(run, episode, steps=100))


def test_the_articles_update_assigns_at_a_terminal_state() -> None:
    run = qtab.train("FrozenLake-v1", seed=0, episodes=9, terminal_update="assign", initial_q=0.5, learning_rate=0.1)
    last = qtab.explain(run, 8, start=int(run.episode_lengths[8]) - 1)[0]
    assert last.terminated
    assert last.updates[0].assigned
    assert last.after == last.reward == 0.0
    assert last.updates[0].numbers[-1] == "Q(S, A) <- 0"


def reasons(**options: Any) -> list[str]:
    run = qtab.train(CAR, **{**SMALL, **options})
    return [step.choice.reason for step in qtab.explain(run, 2, steps=100).steps]


def test_the_reasons_are_those_of_the_policy() -> None:
    assert set(reasons(epsilon=0.0)) == {"greedy"}
    assert set(reasons(epsilon=1.0, epsilon_schedule="constant")) == {"explored"}
    assert set(reasons()) == {"greedy", "explored"}
    assert set(reasons(exploration="softmax", epsilon=None)) == {"softmax"}


@pytest.mark.parametrize("ties", ["first", "random"])
def test_planted_ties_are_told_from_the_largest_value(ties: Any) -> None:
    options = {**SMALL, "epsilon": 0.0, "ties": ties, "initial_q": 0.0, "learning_rate": 0.5}
    first, *others = qtab.explain(qtab.train(CAR, **options), 0, steps=60).steps
    assert (first.choice.reason, first.choice.tied) == ("tie broken", 3)
    assert first.choice.probability == (1.0 if ties == "first" else pytest.approx(1 / 3))
    assert ("drawn from" if ties == "random" else "the first of") in str(first.choice)
    for step in others:
        largest = max(step.choice.values)
        assert step.choice.values[step.choice.action] == largest
        assert (step.choice.reason == "tie broken") == (step.choice.values.count(largest) > 1)


def test_the_steps_are_those_of_the_run() -> None:
    run = qtab.train(CAR, record=1, **SMALL)
    explanation = qtab.explain(run, 5, steps=100)
    assert [step.action for step in explanation.steps] == list(run.recordings[-1].actions)
    assert explanation.episode_return == run.episode_returns[5] == sum(step.reward for step in explanation.steps)
    for step, following in zip(explanation.steps, explanation.steps[1:], strict=False):
        assert np.array_equal(step.next_observation, following.observation)
        assert step.cell == run.discretizer.cell(step.observation)
    assert [step.step for step in qtab.explain(run, 5, steps=3, start=4).steps] == [4, 5, 6]
    assert [step.step for step in qtab.explain(run, 5, steps=9, start=58).steps] == [58, 59]


def test_n_step_sarsa_waits_and_catches_up() -> None:
    run = qtab.train(CAR, algorithm="n_step_sarsa", n_steps=5, **SMALL)
    steps = qtab.explain(run, 1, steps=100).steps
    assert [len(step.updates) for step in steps] == [0] * 4 + [1] * 55 + [5]
    assert steps[3].pending == (0, 1, 2, 3)
    assert steps[3].target is steps[3].td_error is steps[3].before is steps[3].after is None
    assert [update.step for update in steps[-1].updates] == [55, 56, 57, 58, 59]
    assert "steps 0 to 3" in str(qtab.explain(run, 1, steps=4))


def test_an_environment_object_is_explained_with_a_new_one() -> None:
    run = qtab.train(Room(), seed=0, episodes=4)
    assert len(qtab.explain(run, 3, env=Room())) > 0


@pytest.mark.parametrize(
    ("env", "state", "action"),
    [
        ("FrozenLake-v1", "row 0, column 0", {"left", "down", "right", "up"}),
        ("CliffWalking-v1", "row 3, column 0", {"left", "down", "right", "up"}),
        ("Taxi-v4", "taxi in row", {"south", "north", "east", "west", "pick up", "drop off"}),
        ("Blackjack-v1", "player's sum", {"stick", "hit"}),
        ("CartPole-v1", "cart position", {"push left", "push right"}),
        ("Pendulum-v1", "cos θ", {"torque -2 N m", "torque 0 N m", "torque 2 N m"}),
        ("Acrobot-v1", "cos θ1", {"torque -1", "torque 0", "torque +1"}),
        ("qtab/MaximizationBias-v0", "state A", {"left", "right"}),
    ],
)
def test_states_and_actions_are_named(env: str, state: str, action: set[str]) -> None:
    run = qtab.train(env, seed=0, episodes=1, max_episode_steps=30)
    step = qtab.explain(run)[0]
    assert step.state.startswith(state)
    assert step.action_name in action


def test_an_episode_of_one_step_is_named_in_the_singular() -> None:
    blackjack = qtab.train("Blackjack-v1", seed=0, episodes=10)
    short, long = int(np.argmin(blackjack.episode_lengths)), int(np.argmax(blackjack.episode_lengths))
    assert f"episode {short}: 1 step, " in qtab.explain(blackjack, short).heading
    assert f"{blackjack.episode_lengths[long]} steps, " in qtab.explain(blackjack, long).heading


def test_it_prints_as_text_and_as_a_table() -> None:
    explanation = qtab.explain(qtab.train(CAR, **SMALL), 1, steps=2)
    assert "\n" not in repr(explanation)
    assert len(repr(explanation)) < 200
    text = str(explanation)
    assert "target = R + γ max Q(S', a)" in text
    assert max(map(len, text.splitlines())) < 160
    page = explanation._repr_html_()
    assert page.count("<tr>") == 3
    assert "S', a" not in page  # escaped


def test_bad_arguments_are_named() -> None:
    run = qtab.train(CAR, **SMALL)
    with pytest.raises(ValueError, match="episode must be an integer from 0 to 5, got 6"):
        qtab.explain(run, 6)
    with pytest.raises(ValueError, match="start must be an integer from 0 to 59, got 60"):
        qtab.explain(run, 1, start=60)
    with pytest.raises(ValueError, match="steps must be an integer of at least 1, got 0"):
        qtab.explain(run, 1, steps=0)
    with pytest.raises(TypeError, match=r"run must be a Run, got 'run\.npz'; qtab\.load"):
        qtab.explain("run.npz")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="env must be an environment, got 3"):
        qtab.explain(run, env=3)  # type: ignore[arg-type]
    other = replace(run, episode_returns=run.episode_returns + 1.0)
    with pytest.raises(RuntimeError, match="does not repeat this run: episode 0 differs"):
        qtab.explain(other, 2)
    nothing = replace(run, episode_returns=np.empty(0), completed=False)
    with pytest.raises(ValueError, match="run must have a finished episode"):
        qtab.explain(nothing)


@pytest.mark.parametrize(
    ("wrapper", "words"),
    [
        (lambda env: gym.wrappers.TimeAwareObservation(env, flatten=False), "{obs: 314, time: (0)}"),
        (lambda env: gym.wrappers.FrameStackObservation(env, 2), "(314, 314)"),
        (
            lambda env: gym.wrappers.TransformObservation(
                env,
                lambda state: (state, np.array([1, 0])),
                gym.spaces.Tuple([env.observation_space, gym.spaces.MultiBinary(2)]),
            ),
            "(314, (1, 0))",
        ),
    ],
)
def test_observations_of_several_parts_are_listed(wrapper: Any, words: str) -> None:
    run = qtab.train(wrapper(gym.make("Taxi-v4")), episodes=1, seed=0, max_episode_steps=5)
    first = qtab.explain(run, steps=1, env=wrapper(gym.make("Taxi-v4"))).steps[0]
    assert first.state == words
