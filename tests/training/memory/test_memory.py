"""Memory is checked before training, and running out of it raises MemoryError with what was learned."""

import itertools
import json
from typing import Any

import pytest

import qtab
from support.parity import run_of
from support.processes.interrupts import in_a_process
from support.processes.posix import posix_only

CAR = "MountainCar-v0"


@pytest.mark.parametrize("episodes", [10**13, 2**62])
def test_too_many_episodes_are_refused_before_the_first(episodes):
    with pytest.raises(MemoryError, match=rf"^{episodes:,} episodes would take \S+ TiB, more than half of the machine"):
        qtab.train(CAR, episodes=episodes)


def test_too_many_recordings_are_refused_before_the_first_episode():
    with pytest.raises(MemoryError, match=r"^100,000 episodes with 100,000 recordings would take"):
        qtab.train(CAR, episodes=10**5, record=10**13, memory_limit=10**7)


@pytest.mark.parametrize("settings", [{"algorithm": "dyna_q"}, {"algorithm": "sarsa_lambda"}, {"schedule": "visits"}])
def test_what_an_algorithm_keeps_for_each_value_counts(settings):
    table = 8 * 19 * 15 * 3
    if settings == {"schedule": "visits"}:
        settings = {"learning_rate_schedule": "visits", "learning_rate": 1.0}
    with pytest.raises(MemoryError, match=r"^1 episode with a table of 285 rows of 3 actions would take"):
        qtab.train(CAR, episodes=1, memory_limit=2 * table + 100, **settings)
    assert qtab.train(CAR, episodes=1, memory_limit=2 * table + 100, algorithm="sarsa").completed
    shared: dict[str, Any] = {"grid": {"discount": [0.9]}, "seeds": 1, "episodes": 1, "memory_limit": table + 1000}
    with pytest.raises(MemoryError, match=r"^runs of 1 episode would take"):
        qtab.sweep(CAR, **shared, **settings)
    assert len(qtab.sweep(CAR, **shared, algorithm="sarsa")) == 1


@pytest.mark.parametrize(("limit", "error"), [(0, ValueError), (1.5, TypeError), (True, TypeError)])
def test_a_memory_limit_is_a_positive_integer(limit, error):
    with pytest.raises(error, match="memory_limit must be an integer of at least 1"):
        qtab.train(CAR, episodes=1, memory_limit=limit)


def test_recordings_stop_at_the_memory_limit():
    limits: dict[str, Any] = {"env_kwargs": {"goal_velocity": 1.0}, "max_episode_steps": 1000, "episodes": 50}
    message = r"^the recordings would exceed memory_limit=500000 \(488 KiB\); record fewer episodes with record=, or"
    with pytest.raises(MemoryError, match=message) as caught:
        qtab.train(CAR, record=50, memory_limit=500_000, seed=0, **limits)
    run = run_of(caught.value)
    assert 10 < len(run.episode_returns) == len(run.recordings) < 50
    # Those that are not kept make room for later ones.
    assert qtab.train(CAR, record=2, memory_limit=500_000, seed=0, **limits).completed


ENDLESS: dict[str, Any] = {"env_kwargs": {"goal_velocity": 1.0}, "episodes": 1, "max_episode_steps": 10**7, "seed": 0}
GROWING: dict[str, dict[str, Any]] = {
    "monte_carlo": {},
    "monte_carlo_es": {},
    "off_policy_monte_carlo": {},
    "reinforce": {},
    "reinforce_with_baseline": {},
    "n_step_sarsa": {"n_steps": 10**6},
    "n_step_tree_backup": {"n_steps": 10**6},
    "n_step_q_sigma": {"n_steps": 10**6},
}
"""The algorithms that store an episode, in settings where all of it is stored."""


@pytest.mark.parametrize("backend", ["rust", "gymnasium"])
@pytest.mark.parametrize("algorithm", GROWING)
def test_what_an_algorithm_stores_of_an_episode_stops_at_the_memory_limit(algorithm, backend):
    settings = {**ENDLESS, "algorithm": algorithm, **GROWING[algorithm], "bins": 2, "discretizer": "bins"}
    message = r"^what the algorithm stores during the run .* would exceed memory_limit=300000 .* max_episode_steps="
    with pytest.raises(MemoryError, match=message) as caught:
        qtab.train(CAR, memory_limit=300_000, backend=backend, **settings)
    run = run_of(caught.value)
    assert not run.completed
    if backend == "rust":  # with more memory it continues within the episode
        with pytest.raises(MemoryError, match="memory_limit=3000000"):
            qtab.resume(run, memory_limit=3_000_000)
        with pytest.raises(MemoryError, match="would exceed memory_limit=300000"):
            qtab.train_many(
                CAR, [0], memory_limit=300_000, **{name: settings[name] for name in settings if name != "seed"}
            )


@pytest.mark.parametrize("env", ["qtab/KArmedBandit-v0"])
def test_the_outcomes_of_a_stochastic_model_stop_at_the_memory_limit(env):
    settings: dict[str, Any] = {"algorithm": "dyna_q", "model": "stochastic", "planning_steps": 1, "seed": 0}
    with pytest.raises(MemoryError, match=r"the outcomes of its model.* would exceed memory_limit=2000000"):
        qtab.train(env, episodes=50_000, memory_limit=2_000_000, **settings)
    assert qtab.train(env, episodes=50_000, memory_limit=20_000_000, **settings).completed


def test_runs_of_one_call_give_back_the_memory_of_their_episodes():
    settings: dict[str, Any] = {"algorithm": "monte_carlo", "episodes": 1, "max_episode_steps": 5000}
    settings["env_kwargs"] = {"goal_velocity": 1.0}
    assert qtab.train_many(CAR, 20, threads=1, memory_limit=800_000, **settings).completed


@pytest.mark.slow
def test_processes_that_are_not_started_take_no_share_of_the_memory():
    settings: dict[str, Any] = {"algorithm": "monte_carlo", "episodes": 1, "max_episode_steps": 5000}
    settings |= {"env_kwargs": {"goal_velocity": 1.0}, "backend": "gymnasium"}
    assert qtab.train_many(CAR, 1, threads=16, memory_limit=800_000, **settings).completed


@pytest.mark.parametrize("seeds", [10**9, 10**12, 10**30])
def test_too_many_seeds_are_refused_without_a_list_of_them(seeds):
    with pytest.raises(MemoryError, match=rf"^{seeds:,} runs would take .* more than half of the machine"):
        qtab.train_many(CAR, seeds)
    with pytest.raises(MemoryError, match=rf"{seeds:,} runs would take .* more than half of the machine"):
        qtab.sweep(CAR, {"discount": [0.9]}, seeds=seeds)


def test_seeds_without_an_end_are_refused():
    with pytest.raises(MemoryError, match=r"^more than 3,906 runs would take"):
        qtab.train_many(CAR, itertools.count(), memory_limit=10**6)


LIMIT = """
import resource
def limit_memory(more):
    status = open("/proc/self/status").read()
    used = int(status.split("VmSize:")[1].split()[0]) * 1024
    resource.setrlimit(resource.RLIMIT_AS, (used + more, resource.RLIM_INFINITY))
try:
    import resource
    open("/proc/self/status").close()
except (ImportError, OSError):
    sys.exit(77)
threading.Thread(target=print).start()  # the stack and the arena of a thread
qtab.train("MountainCar-v0", episodes=1)
limit_memory(50 * 2**20)
"""


KEPT = "print(json.dumps([error.run.completed, bool(np.isfinite(error.run.tables).all()), str(error)]))"


@posix_only
@pytest.mark.slow
@pytest.mark.parametrize(
    "call",
    [
        "qtab.train('MountainCar-v0', episodes=10**9, max_episode_steps=1, memory_limit=2**60)",
        "qtab.train('MountainCar-v0', record=10, memory_limit=2**60, **ENDLESS)",
        "qtab.train('MountainCar-v0', algorithm='n_step_sarsa', n_steps=10**6, discretizer='tiles', tilings=32, "
        "learning_rate=0.1, max_episode_steps=10**9, env_kwargs={'goal_velocity': 1.0})",
    ],
)
def test_running_out_of_memory_raises_and_keeps_the_run(call):
    done = in_a_process(LIMIT + f"try:\n    {call}\nexcept MemoryError as error:\n    {KEPT}")
    completed, finite, text = json.loads(done.stdout.splitlines()[-1])
    assert (completed, finite) == (False, True)
    assert text.startswith("out of memory: ")
