"""Ordinary Gymnasium classes of many styles: rewritten, they compute the same bits."""

from collections.abc import Callable
from typing import Any

import gymnasium as gym
import pytest

from qtab.compilation.rewriting import rewrite
from support.environments.gym_classes import control, games, grids, operations
from support.lockstep.rewriting import assert_equal_steps, assert_nothing_refused, compiled_with_checks


class ConstantDictEnv(gym.Env):
    """Its first observation is a dict of constants."""

    observation_space = gym.spaces.Dict({"cell": gym.spaces.Discrete(5), "found": gym.spaces.Discrete(2)})
    action_space = gym.spaces.Discrete(2)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.cell = 0
        return {"cell": 0, "found": 0}, {}

    def step(self, action):
        self.cell = min(self.cell + action, 4)
        if self.cell == 4 and self.np_random.random() < 0.5:
            return {"cell": 4, "found": 1}, 1.0, True, False, {}
        return {"cell": self.cell, "found": 0}, 0.0, False, False, {}


CLASSES: dict[str, Callable[[], gym.Env]] = {
    "grid world of the documentation": grids.GridWorldEnv,
    "cliff with tuples and a set": grids.CliffEnv,
    "maze with a list and an array of booleans": grids.MazeEnv,
    "key and door": grids.KeyDoorEnv,
    "masks in the info dict": grids.MaskedGridEnv,
    "thermostat": control.ThermostatEnv,
    "pendulum with a dataclass": control.PendulumEnv,
    "cart pole, Euler": control.CartEnv,
    "cart pole, semi-implicit": lambda: control.CartEnv("semi-implicit"),
    "subclass of Gymnasium's MountainCar": control.TupleMountainCarEnv,
    "lander in place": control.LanderEnv,
    "inventory": operations.InventoryEnv,
    "queue in an array": operations.QueueEnv,
    "elevator": operations.ElevatorEnv,
    "machine that wears out": operations.MachineEnv,
    "trading": operations.TradingEnv,
    "dice": games.DiceEnv,
    "tic-tac-toe": games.TicTacToeEnv,
    "bandit that drifts": games.BanditEnv,
    "base class of the user": games.BaseGame,
    "inheritance": games.RunningGame,
    "gambler": games.GamblerEnv,
    "observation of constants": ConstantDictEnv,
}
MASKS: dict[str, Callable[[Any], Any]] = {"tic-tac-toe": lambda env: env.action_masks()}
EPISODES_END = {name for name in CLASSES if not name.startswith(("pendulum", "subclass of Gym", "cliff"))}


@pytest.mark.parametrize("name", CLASSES)
def test_plain_functions_equal_the_class(name: str) -> None:
    env = CLASSES[name]()
    ended = assert_equal_steps(env, rewrite(env), 1500, 7, MASKS.get(name))
    assert ended or name not in EPISODES_END


QUICK = ("thermostat", "cliff with tuples and a set")
"""Compiling takes seconds; these cover the mechanism."""


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[] if name in QUICK else pytest.mark.slow) for name in CLASSES]
)
def test_compiled_functions_equal_the_class(name: str) -> None:
    pytest.importorskip("numba")
    env = CLASSES[name]()
    compiled = compiled_with_checks(rewrite(env))
    assert_equal_steps(env, compiled, 3000, 11, MASKS.get(name))
    assert_nothing_refused()
