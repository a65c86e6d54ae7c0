"""``gymnasium.make_vec("qtab/…")`` takes what it takes for Gymnasium's own environments."""

import subprocess
import sys
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.envs.registration import EnvSpec, VectorizeMode
from gymnasium.utils.env_checker import data_equivalence
from gymnasium.vector import AutoresetMode, SyncVectorEnv

import qtab
from support.lockstep.vector import assert_equal

WRAPPED: list[dict[str, Any]] = [
    {"wrappers": [gym.wrappers.TimeAwareObservation]},
    {
        "wrappers": (lambda env: gym.wrappers.TransformReward(env, lambda reward: 2 * float(reward)),),
        "max_episode_steps": 5,
    },
    {"vector_kwargs": {"autoreset_mode": AutoresetMode.SAME_STEP}},
    {"vector_kwargs": {"copy": False, "autoreset_mode": "Disabled"}},
    {"vector_kwargs": {"observation_mode": "different"}},
    {"wrappers": [gym.wrappers.TimeAwareObservation], "vector_kwargs": {"autoreset_mode": "SameStep", "copy": False}},
]


def made(name: str, **kwargs: Any) -> Any:
    return gym.make_vec(name, num_envs=3, **kwargs)


def run(env: Any, steps: int = 20) -> list[Any]:
    env.action_space.seed(0)
    results: list[Any] = [env.reset(seed=4)]
    for _ in range(steps):
        results.append(env.step(env.action_space.sample()))
        over = results[-1][2] | results[-1][3]
        if env.metadata["autoreset_mode"] is AutoresetMode.DISABLED and over.any():
            results.append(env.reset(options={"reset_mask": over}))
    return [(np.array(result[0]), *result[1:]) for result in results]


@pytest.mark.parametrize("kwargs", WRAPPED, ids=lambda kwargs: " ".join(kwargs))
@pytest.mark.parametrize("name", ["MountainCar-v0", "Pendulum-v1"])
def test_wrappers_and_vector_kwargs_work_as_for_gymnasiums_environments(name, kwargs):
    mine, gymnasiums = (made(full, **kwargs) for full in (f"qtab/{name}", name))
    assert isinstance(gymnasiums, SyncVectorEnv)
    for attribute in ("metadata", "observation_space", "action_space", "single_observation_space", "num_envs"):
        assert getattr(mine, attribute) == getattr(gymnasiums, attribute)
    assert_equal(run(mine), run(gymnasiums))
    again = gym.make_vec(mine.spec)
    assert type(again) is type(mine)
    assert again.metadata == mine.metadata
    assert data_equivalence(run(again), run(mine), exact=True)


def test_rust_steps_all_sub_environments_unless_they_are_wrapped():
    assert isinstance(gym.make_vec("qtab/Taxi-v4", vector_kwargs={"copy": False}), qtab.RustVectorEnv)
    assert isinstance(gym.make_vec("qtab/Taxi-v4", vector_kwargs={"observation_mode": "same"}), qtab.RustVectorEnv)
    wrapped = gym.make_vec("qtab/Taxi-v4", wrappers=[gym.wrappers.TimeAwareObservation], copy=False, threads=2)
    assert isinstance(wrapped, SyncVectorEnv)
    assert wrapped.copy is False
    assert type(wrapped.envs[0].unwrapped).__module__ == "qtab.envs.toy_text"


@pytest.mark.parametrize("mode", ["sync", VectorizeMode.SYNC])
def test_other_vectorization_modes_take_both_as_ever(mode):
    env = gym.make_vec(
        "qtab/MountainCar-v0",
        num_envs=2,
        vectorization_mode=mode,
        wrappers=[gym.wrappers.TimeAwareObservation],
        vector_kwargs={"copy": False},
    )
    assert isinstance(env, SyncVectorEnv)
    assert env.copy is False
    assert env.spec is not None
    assert env.spec.kwargs["vector_kwargs"] == {"copy": False}
    assert isinstance(gym.make_vec(env.spec), SyncVectorEnv)


def test_specs_stay_those_of_gymnasium():
    spec = gym.spec("qtab/FrozenLake8x8-v1")
    assert spec.kwargs == gym.spec("FrozenLake8x8-v1").kwargs
    assert EnvSpec.from_json(spec.to_json()) == spec
    made = gym.make_vec("qtab/FrozenLake8x8-v1", num_envs=2, wrappers=[gym.wrappers.TimeAwareObservation])
    assert made.single_observation_space.shape == (64 + 1,)
    assert gym.spec("qtab/FrozenLake8x8-v1").kwargs == {"map_name": "8x8"}


def test_bad_arguments_name_what_is_wrong():
    with pytest.raises(TypeError, match="copy must be given once, got True and in vector_kwargs False"):
        gym.make_vec("qtab/Taxi-v4", copy=True, vector_kwargs={"copy": False})
    with pytest.raises(TypeError, match="unexpected keyword argument 'threds'"):
        gym.make_vec("qtab/Taxi-v4", vector_kwargs={"threds": 2})
    with pytest.raises(ValueError, match=r"name must be one of .*, got 'CartPole' \(did you mean 'CartPole-v"):
        qtab.RustVectorEnv("CartPole")
    with pytest.raises(TypeError, match="name must be one of"):
        qtab.RustVectorEnv(3)  # type: ignore[arg-type]
    assert qtab.RustVectorEnv("qtab/Taxi-v4", 2).is_native


WORKERS = """
import gymnasium as gym, numpy as np

def env():
    return gym.make("qtab:qtab/MountainCar-v0")

if __name__ == "__main__":
    import qtab
    for context in ("spawn", "forkserver"):
        by_id = gym.make_vec(
            "qtab/MountainCar-v0", num_envs=2, vectorization_mode="async", vector_kwargs={"context": context}
        )
        by_function = gym.vector.AsyncVectorEnv([env] * 2, context=context)
        for envs in (by_id, by_function):
            observations, _ = envs.reset(seed=3)
            observations, *_ = envs.step(np.array([0, 2]))
            print(observations.tobytes().hex(), envs.call("model"))
            envs.close()
"""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="there is no forkserver")
def test_workers_started_by_spawn_and_forkserver_find_the_environments(tmp_path):
    program = tmp_path / "workers.py"
    program.write_text(WORKERS)
    done = subprocess.run([sys.executable, program], capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert len(lines) == 4
    assert len(set(lines)) == 1
    assert "('MountainCar', 'MountainCar')" in lines[0]
