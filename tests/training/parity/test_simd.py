"""Batches, tile coding and vector environments give the same numbers, whatever the vector instructions."""

import hashlib
import os
import subprocess
import sys
from typing import Any

import gymnasium as gym
import numpy as np

import qtab
from support.repository import ROOT

PROGRAM = "from training.parity.test_simd import digest; print(digest())"


def digest() -> str:
    """Hashes the tables of batches, values of tile coding, and the observations of vector environments."""
    hashed = hashlib.sha256()
    for env_id in ("MountainCar-v0", "CartPole-v1"):
        runs = qtab.train_many(env_id, seeds=range(8), episodes=30, tables=True, threads=1)
        assert runs.tables is not None
        hashed.update(runs.episode_returns.tobytes() + runs.tables.tobytes())
        for envs in (gym.make_vec(f"qtab/{env_id}", num_envs=19), qtab.RustVectorEnv(env_id, 19)):
            observation = envs.reset(seed=0)[0][0]
            rng = np.random.default_rng(0)
            for _ in range(300):
                observations, *_ = envs.step(rng.integers(2, size=19))
                hashed.update(observations.tobytes())
            envs.close()
        tiles: dict[str, Any] = {"discretizer": "tiles", "tilings": 8, "episodes": 5}
        for rule in ("sarsa", "expected_sarsa"):
            tiled_runs = qtab.train_many(env_id, seeds=range(8), algorithm=rule, tables=True, threads=1, **tiles)
            assert tiled_runs.tables is not None
            hashed.update(tiled_runs.tables.tobytes())
        for algorithm in ("q_learning", "sarsa_lambda"):
            tiled = qtab.train(env_id, seed=0, algorithm=algorithm, **tiles)
            hashed.update(tiled.q_values(observation).tobytes())
    return hashed.hexdigest()


def run(simd: str) -> subprocess.CompletedProcess[str]:
    """Computes the digest in a process with this value of the environment variable."""
    env = {**os.environ, "QTAB_SIMD": simd}
    return subprocess.run(
        [sys.executable, "-c", PROGRAM], env=env, capture_output=True, text=True, check=False, cwd=ROOT / "tests"
    )


def test_narrower_vector_instructions_give_the_same_numbers() -> None:
    expected = digest()
    for simd in ("plain", "avx2"):
        narrower = run(simd)
        assert narrower.stdout.strip() == expected, narrower.stderr


def test_an_unknown_level_is_refused() -> None:
    refused = run("avx9")
    assert "QTAB_SIMD must be 'plain', 'avx2' or unset, got 'avx9'" in refused.stderr
