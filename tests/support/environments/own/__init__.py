"""Environments as users write them, with ``qtab.FunctionalEnv``."""

from typing import Any

from support.environments.own.book.access_control import AccessControl as AccessControl
from support.environments.own.book.bandit import Bandit as Bandit
from support.environments.own.book.cliff import Cliff as Cliff
from support.environments.own.book.gambler import Gambler as Gambler
from support.environments.own.book.random_walk import RandomWalk as RandomWalk
from support.environments.own.book.robot import Robot as Robot
from support.environments.own.book.windy_grid import WindyGrid as WindyGrid
from support.environments.own.control.cart_pole import CartPole as CartPole
from support.environments.own.control.mountain_car import MountainCar as MountainCar
from support.environments.own.control.noisy_pendulum import NoisyPendulum as NoisyPendulum
from support.environments.own.control.thermostat import Thermostat as Thermostat
from support.environments.own.games.mine_field import MineField as MineField
from support.environments.own.games.tic_tac_toe import TicTacToe as TicTacToe
from support.environments.own.games.twenty_one import TwentyOne as TwentyOne
from support.environments.own.grids.key_and_door import KeyAndDoor as KeyAndDoor
from support.environments.own.grids.slippery_grid import SlipperyGrid as SlipperyGrid
from support.environments.own.grids.taxi import Taxi as Taxi
from support.environments.own.operations.elevator import Elevator as Elevator
from support.environments.own.operations.epidemic import Epidemic as Epidemic
from support.environments.own.operations.inventory import Inventory as Inventory
from support.environments.own.operations.queue import Queue as Queue

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
