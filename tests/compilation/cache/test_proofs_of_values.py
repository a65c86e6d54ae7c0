"""Compiled code is compared with Python for each value of the parameters, since a value may select a branch."""

from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab
from qtab.compilation import NotCompilable, functional, ordinary
from qtab.compilation.cache.store import Store
from qtab.compilation.functional import compiled_env
from qtab.compilation.ordinary import OrdinaryEnv

pytest.importorskip("numba")


class Branch(qtab.FunctionalEnv):
    """Its Poisson numbers are not drawn in compiled code, but are only reached if ``slip`` is positive."""

    observation_space: gym.Space[Any] = gym.spaces.Box(-np.inf, np.inf, (1,), np.float64)
    action_space: gym.Space[Any] = gym.spaces.Discrete(2)

    def __init__(self, slip: float = 0.0) -> None:
        self.slip = slip

    def initial_state(self, rng: np.random.Generator) -> Any:
        return rng.uniform(1.0, 2.0)

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        x = 1.0 + rng.random()
        if self.slip > 0.0:
            x = float(rng.poisson(12.0))
        return x, x, rng.random() < 0.05

    def observe(self, state: Any) -> Any:
        return state


class OrdinaryBranch(gym.Env[Any, Any]):
    observation_space = gym.spaces.Discrete(1)
    action_space = gym.spaces.Discrete(2)

    def __init__(self, slip: float = 0.0) -> None:
        self.slip = slip

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any:
        super().reset(seed=seed)
        return 0, {}

    def step(self, action: Any) -> Any:
        x = 1.0 + self.np_random.random()
        if self.slip > 0.0:
            x = 1.0 + float(np.exp(-x))
        return 0, x, self.np_random.random() < 0.05, False, {}


@pytest.fixture
def proofs(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[Any]:
    """The proofs that are made, from empty memories and an empty folder of files."""
    monkeypatch.setattr("qtab.compilation.cache.code_files._folders", lambda _: iter([tmp_path / "code"]))
    made: list[Any] = []
    for module in (functional, ordinary):
        prove: Any = module.prove

        def counted(*arguments: Any, prove: Any = prove) -> None:
            made.append(arguments)
            prove(*arguments)

        monkeypatch.setattr(module, "prove", counted)
        monkeypatch.setattr(module, "_store", Store())
    return made


@pytest.mark.parametrize(("make", "compiled"), [(Branch, compiled_env), (OrdinaryBranch, OrdinaryEnv)])
def test_another_value_is_compared_as_well(make: Any, compiled: Any, proofs: list[Any]) -> None:
    compiled(make(0.0))
    for slip in (0.3, 0.3, 0.4):
        with pytest.raises(NotCompilable, match="in compiled code"):
            compiled(make(slip))
    compiled(make(0.0))


def test_each_value_is_compared_once_by_all_processes(proofs: list[Any], monkeypatch: pytest.MonkeyPatch) -> None:
    def outcomes() -> list[str]:
        found = []
        for slip in (0.0, 0.3, -1.0, 0.3, 0.0):
            try:
                compiled_env(Branch(slip))
                found.append("")
            except NotCompilable as refusal:
                found.append(str(refusal))
        return found

    first = outcomes()
    assert [bool(one) for one in first] == [False, True, False, True, False]
    assert len(proofs) == 3
    monkeypatch.setattr(functional, "_store", Store())
    assert outcomes() == first
    assert len(proofs) == 3


class Bins(qtab.FunctionalEnv):
    """The shape of its states depends on the value of an attribute."""

    observation_space = gym.spaces.Discrete(5)
    action_space = gym.spaces.Discrete(2)

    def __init__(self, n: int) -> None:
        self.n = n

    def initial_state(self, rng: np.random.Generator) -> Any:
        return np.zeros(self.n)

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        after = state.copy()
        after[0] = min(after[0] + 1.0, 4.0)
        return after, 1.0, after[0] >= 4.0

    def observe(self, state: Any) -> Any:
        return int(state[0])


def test_states_of_another_shape_need_other_code() -> None:
    for n in (3, 5, 2):
        assert compiled_env(Bins(n))[0].state_size == 8 * n


def test_a_failure_of_numba_is_not_remembered(proofs: list[Any], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "1")
    with pytest.raises(NotCompilable, match=r"^NUMBA_DISABLE_JIT is set$"):
        OrdinaryEnv(OrdinaryBranch())
    monkeypatch.setenv("NUMBA_DISABLE_JIT", "0")
    with monkeypatch.context() as failing:
        failing.setattr("qtab.compilation.cache.machine_code.make", _no_memory)
        with pytest.raises(NotCompilable, match="Numba failed with MemoryError"):
            OrdinaryEnv(OrdinaryBranch())
    OrdinaryEnv(OrdinaryBranch())


def _no_memory(*_: Any) -> None:
    raise MemoryError


class Counting(Branch):
    """Changes an array of ``self`` through a function whose result is that array."""

    def __init__(self) -> None:
        super().__init__()
        self.counts = np.zeros(3)

    def transition(self, state: Any, action: int, rng: np.random.Generator) -> Any:
        counts = np.ascontiguousarray(self.counts)
        counts[action] += 1.0
        return state, counts[action], rng.random() < 0.05


def test_changed_parameters_are_found_without_a_change_of_the_environment(proofs: list[Any]) -> None:
    env = Counting()
    with pytest.raises(NotCompilable, match=r"is changed.*copy the array first") as refused:
        compiled_env(env)
    # Older versions of Numba refuse the function themselves; the newest take its array for a new one.
    assert len(proofs) == ("an array of self is changed" in str(refused.value))
    assert not env.counts.any()
