"""``runs[i]``, slices of runs, and how many last episodes are averaged."""

import numpy as np
import pytest

import qtab
from support.parity import assert_same_run


@pytest.fixture(scope="module")
def runs() -> qtab.Runs:
    return qtab.train_many("FrozenLake-v1", seeds=range(5, 11), episodes=120, tables=True)


@pytest.mark.parametrize("index", [0, 5, -1, -6, np.int64(2)])
def test_an_index_gives_the_run_of_its_seed(runs, index):
    assert_same_run(runs[index], qtab.train("FrozenLake-v1", seed=range(5, 11)[index], episodes=120))


@pytest.mark.parametrize("part", [slice(1, 4), slice(None, None, 2), slice(None, None, -1), slice(-2, None)], ids=str)
def test_a_slice_gives_the_runs_of_its_seeds(runs, part):
    chosen = runs[part]
    assert isinstance(chosen, qtab.Runs)
    assert chosen.seeds == runs.seeds[part]
    assert chosen.config == runs.config.replace(seed=chosen.seeds[0])
    assert chosen.final_returns().tolist() == runs.final_returns()[part].tolist()
    assert chosen.seconds == pytest.approx(runs.seconds * len(chosen) / len(runs))
    for run, seed in zip(chosen, chosen.seeds, strict=True):
        assert_same_run(run, runs[runs.seeds.index(seed)])


def test_a_slice_may_be_empty_and_needs_no_tables(runs):
    assert len(runs[3:3]) == 0
    assert repr(runs[3:3]) == "<Runs of FrozenLake-v1: q_learning, 0 seeds, 120 episodes each>"
    without = qtab.train_many("FrozenLake-v1", seeds=3, episodes=2)
    assert len(without[1:]) == 2


@pytest.mark.parametrize("index", [6, -7, 10**30])
def test_an_index_out_of_range_is_refused(runs, index):
    with pytest.raises(IndexError, match=f"^there are 6 runs, got index {index}$"):
        runs[index]


@pytest.mark.parametrize("index", ["a", 1.0, None, True, [1, 2], (0, 1)], ids=str)
def test_an_index_of_another_type_is_refused(runs, index):
    with pytest.raises(TypeError, match=r"^index must be an integer or a slice, got "):
        runs[index]


def test_the_last_episodes_must_be_there(runs):
    assert runs.final_returns().tolist() == runs.episode_returns[:, -100:].mean(axis=1).tolist()
    assert runs.final_returns(120).tolist() == runs.episode_returns.mean(axis=1).tolist()
    short = qtab.train_many("FrozenLake-v1", seeds=2, episodes=7)
    assert short.final_returns().tolist() == short.episode_returns.mean(axis=1).tolist()
    for last in (121, 10**9, 0, -1):
        with pytest.raises(ValueError, match=f"^last must be an integer from 1 to 120, got {last}$"):
            runs.final_returns(last)
