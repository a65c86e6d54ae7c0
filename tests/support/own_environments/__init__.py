"""Environments as users write them, with ``qtab.FunctionalEnv``."""

from typing import Any

from support.own_environments.access_control import AccessControl
from support.own_environments.bandit import Bandit
from support.own_environments.cart_pole import CartPole
from support.own_environments.cliff import Cliff
from support.own_environments.elevator import Elevator
from support.own_environments.epidemic import Epidemic
from support.own_environments.gambler import Gambler
from support.own_environments.inventory import Inventory
from support.own_environments.key_and_door import KeyAndDoor
from support.own_environments.mine_field import MineField
from support.own_environments.mountain_car import MountainCar
from support.own_environments.noisy_pendulum import NoisyPendulum
from support.own_environments.queue import Queue
from support.own_environments.random_walk import RandomWalk
from support.own_environments.robot import Robot
from support.own_environments.slippery_grid import SlipperyGrid
from support.own_environments.taxi import Taxi
from support.own_environments.thermostat import Thermostat
from support.own_environments.tic_tac_toe import TicTacToe
from support.own_environments.twenty_one import TwentyOne
from support.own_environments.windy_grid import WindyGrid

ENVIRONMENTS: tuple[Any, ...] = (
    AccessControl,
    Bandit,
    CartPole,
    Cliff,
    Elevator,
    Epidemic,
    Gambler,
    Inventory,
    KeyAndDoor,
    MineField,
    MountainCar,
    NoisyPendulum,
    Queue,
    RandomWalk,
    Robot,
    SlipperyGrid,
    Taxi,
    Thermostat,
    TicTacToe,
    TwentyOne,
    WindyGrid,
)
"""All of them; without arguments they are small."""
