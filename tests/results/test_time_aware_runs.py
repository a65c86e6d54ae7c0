"""Runs whose table has the number of steps taken as its first axis."""

from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.rendering.agent import agent_of
from qtab.rendering.episodes import play_episodes

LAKE = "FrozenLake-v1"
LIMIT = 20


@pytest.fixture(scope="module")
def run() -> qtab.Run:
    return qtab.train(
        LAKE, time_aware=True, max_episode_steps=LIMIT, episodes=300, seed=1, visits=True, snapshots=2, initial_q=1.0
    )


def test_the_axis_of_the_steps_comes_first(run: qtab.Run) -> None:
    assert run.q_table.shape == (LIMIT, 16, 4)
    assert run.policy.shape == (LIMIT, 16)
    assert [(axis.name, len(axis.edges) - 1) for axis in run.axes] == [("steps taken", LIMIT), ("state", 16)]
    assert repr(run.discretizer) == "<TimeAware: 20 × 16 cells>"
    assert run.discretizer.cell(3) == (0, 3)


def test_a_step_is_a_run_like_any_other(run: qtab.Run) -> None:
    assert run.visits is not None
    assert run.snapshots is not None
    for step in (0, 7, LIMIT - 1):
        part = run.at_step(step)
        assert part.q_table.tolist() == run.q_table[step].tolist()
        assert part.policy.tolist() == run.policy[step].tolist()
        assert part.visits is not None
        assert part.visits.tolist() == run.visits[step].tolist()
        assert part.snapshots is not None
        assert part.snapshots.tables[-1].tobytes() == part.tables.tobytes()
        assert run.q_values(4, step=step).tolist() == run.q_table[step, 4].tolist() == part.q_values(4).tolist()
        assert run.values(4, step=step) == run.q_table[step, 4].max()
    for step in (-1, LIMIT):
        with pytest.raises(ValueError, match=rf"step must be .* 19.*, got {step}"):
            run.at_step(step)
    with pytest.raises(ValueError, match="step must be 0 for a run without time_aware=True, got 1"):
        run.at_step(2).q_values(0, step=1)


def test_a_setting_that_an_algorithm_fixes_stays_without_the_steps() -> None:
    run = qtab.train(LAKE, time_aware=True, max_episode_steps=3, episodes=2, seed=1, algorithm="reinforce")
    assert run.at_step(1).config == run.config.replace(time_aware=False)
    assert run.at_step(1).config.on_truncation == "terminate"


def test_the_state_of_the_policy_is_the_number_of_steps_taken(run: qtab.Run) -> None:
    state: Any = None
    for step in range(LIMIT + 2):
        action, state = run.predict(4, state)
        assert (action, state) == (run.policy[min(step, LIMIT - 1), 4], step + 1)
    observations, states = np.array([4, 5, 4]), np.array([0, 3, 19])
    actions, states_after = run.predict(observations, states, episode_start=np.array([False, False, True]))
    assert actions.tolist() == run.policy[[0, 3, 0], [4, 5, 4]].tolist()
    assert states_after.tolist() == [1, 4, 1]
    assert run.predict(observations)[1].tolist() == [1, 1, 1]
    with pytest.raises(ValueError, match="state must hold a number of steps for each of the 3 observations"):
        run.predict(observations, np.array([1, 2]))
    with pytest.raises(TypeError, match="state must hold integers, the numbers of steps taken"):
        run.predict(4, 1.5)


def test_evaluation_plays_the_policy_of_each_step(run: qtab.Run) -> None:
    """As a loop over the environment does that passes the state on, to the bit."""
    played = qtab.evaluate(run, 50, seed=3)
    env = gym.make(LAKE, max_episode_steps=LIMIT)
    for episode in range(50):
        observation, _ = env.reset(seed=3 if episode == 0 else None)
        state, over, total, length = None, False, 0.0, 0
        while not over:
            action, state = run.predict(observation, state)
            observation, reward, terminated, truncated, _ = env.step(action)
            total, length, over = total + float(reward), length + 1, terminated or truncated
        assert (total, length) == (played.returns[episode], played.lengths[episode])
    agent = agent_of(run)
    shown = play_episodes(agent, gym.make(LAKE, max_episode_steps=LIMIT), 50, 3, lambda *_: True)
    assert np.array(shown.lengths).tolist() == played.lengths.tolist()
    with pytest.raises(ValueError, match="max_episode_steps must be 20 for a run with time_aware=True"):
        qtab.evaluate(run, 5, max_episode_steps=30)


def test_the_gap_is_exact(run: qtab.Run) -> None:
    best = qtab.optimum(run)
    gap = best.gap(run)
    played = qtab.evaluate(run, 4000, seed=1)
    assert abs(played.mean_return - gap.greedy_return) <= 3.5 * played.standard_error
    assert (gap.standard_error, gap.attainable, gap.approximation) == (0.0, best.expected_return, 0.0)
    # The policy of an optimum that depends on the steps left returns its expected return.
    policy = np.array([[best.predict(state, step)[0] for state in range(16)] for step in range(LIMIT)])
    table = np.eye(4)[policy][np.newaxis].reshape(1, -1, 4)
    perfect = qtab.train(config=run.config, initial_q=table, learning_rate=0.0, episodes=1)
    assert best.gap(perfect).greedy_return == pytest.approx(best.expected_return, abs=1e-14)


def test_files_hold_it(run: qtab.Run, tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    run.save(path)
    loaded = qtab.load(path)
    assert loaded.config == run.config
    assert loaded.q_table.tobytes() == run.q_table.tobytes()
    assert loaded.predict(4, 7) == run.predict(4, 7)
    with pytest.raises(ValueError, match="plain data describes policies without time_aware"):
        run.to_json(tmp_path / "run.json")
    run.at_step(3).to_json(tmp_path / "run.json")


def test_it_is_explained_and_diagnosed(run: qtab.Run) -> None:
    length = int(run.episode_lengths[250])
    explanation = qtab.explain(run, episode=250, steps=length)
    assert [step.cell[0] for step in explanation.steps if step.cell] == list(range(length))
    assert explanation.steps[-1].next_cell is not None
    assert explanation.steps[-1].next_cell[0] == min(length, LIMIT - 1)
    found = {finding.name for finding in qtab.diagnose(run, seeds=0).findings}
    assert "time-outs treated as terminal" not in found


@pytest.mark.slow
def test_pictures_show_a_step(run: qtab.Run) -> None:
    pytest.importorskip("matplotlib")
    first, later = (qtab.plots.values(run, step=step) for step in (0, 5))
    assert "step 0" in first.get_title(loc="left")
    assert "step 5" in later.get_title(loc="left")
    whole: Any = run.visits
    drawn = [text.get_text() for text in qtab.plots.visits(run).texts]
    assert str(whole.sum(axis=(0, 2))[14]) in drawn
    with pytest.raises(ValueError, match="step must be 0 for a run without time_aware=True, got 1"):
        qtab.plots.policy(run.at_step(0), step=1)


def test_what_would_ignore_the_steps_is_refused(run: qtab.Run) -> None:
    shorter = gym.make(LAKE, max_episode_steps=LIMIT - 1)
    with pytest.raises(ValueError, match="env must have a time limit of at least 20 steps, as in the run with"):
        qtab.evaluate(run, 5, env=shorter)
    with pytest.raises(ValueError, match="policy must not depend on the number of steps taken, got a run with"):
        qtab.policy_values(LAKE, run)


def test_the_command_line_trains_it(tmp_path: Path) -> None:
    from qtab.cli import main

    path = str(tmp_path / "run.npz")
    assert (
        main(["train", LAKE, "--time-aware", "True", "--episodes", "3", "--seed", "0", "--save", path, "--quiet"]) == 0
    )
    assert qtab.load(path).q_table.shape == (100, 16, 4)
