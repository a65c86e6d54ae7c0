"""Environments as users write them, with ``qtab.FunctionalEnv``."""

from typing import Any

from support.own_environments.access_control import AccessControl as AccessControl
from support.own_environments.bandit import Bandit as Bandit
from support.own_environments.cart_pole import CartPole as CartPole
from support.own_environments.cliff import Cliff as Cliff
from support.own_environments.elevator import Elevator as Elevator
from support.own_environments.epidemic import Epidemic as Epidemic
from support.own_environments.gambler import Gambler as Gambler
from support.own_environments.inventory import Inventory as Inventory
from support.own_environments.key_and_door import KeyAndDoor as KeyAndDoor
from support.own_environments.mine_field import MineField as MineField
from support.own_environments.mountain_car import MountainCar as MountainCar
from support.own_environments.noisy_pendulum import NoisyPendulum as NoisyPendulum
from support.own_environments.queue import Queue as Queue
from support.own_environments.random_walk import RandomWalk as RandomWalk
from support.own_environments.robot import Robot as Robot
from support.own_environments.slippery_grid import SlipperyGrid as SlipperyGrid
from support.own_environments.taxi import Taxi as Taxi
from support.own_environments.thermostat import Thermostat as Thermostat
from support.own_environments.tic_tac_toe import TicTacToe as TicTacToe
from support.own_environments.twenty_one import TwentyOne as TwentyOne
from support.own_environments.windy_grid import WindyGrid as WindyGrid

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
