"""Jack's car rental of Sutton & Barto's book (Example 4.2) as a transition table."""

import math
from functools import cache
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from qtab._utils import checks
from qtab.envs.tabular import TabularEnv, Transition

MAX_MOVED = 5
"""The most cars that can be moved overnight; action a moves a - 5 cars from the first location to the second."""
RENTAL = 10.0
"""The reward for each car that is rented."""
MOVE = 2.0
"""The cost of each car that is moved."""
REQUESTS = (3.0, 4.0)
"""The mean number of requests a day at each location."""
RETURNS = (3.0, 2.0)
"""The mean number of returned cars a day at each location."""


def jacks_car_rental(cars: int = 20) -> TabularEnv:
    """Returns Jack's car rental: two locations, between which cars are moved overnight. There is no terminal state.

    A state is ``first * (cars + 1) + second`` for the numbers of cars at the end of a day. Action a moves a - 5 cars
    from the first location to the second, or as many as are available and fit. The next day, Poisson
    numbers of cars are requested and returned at each location; returned cars can be rented from the day after. The
    reward is the expected income of that day, minus the cost of the moved cars. An episode starts with both locations
    half full.

    Args:
        cars: The largest number of cars at a location; more are taken away.

    Raises:
        TypeError: if ``cars`` is not an integer.
        ValueError: if it is less than 1.
    """
    cars = checks.integer("cars", cars, least=1)
    days = [_day(cars, requests, returns) for requests, returns in zip(REQUESTS, RETURNS, strict=True)]
    income = [expected for _, expected in days]
    # A day depends only on the numbers of cars in the morning, not on the move: all moves share its probabilities.
    following = {
        morning: np.outer(days[0][0][morning[0]], days[1][0][morning[1]]).ravel().tolist()
        for morning in product(range(cars + 1), repeat=2)
    }

    @cache
    def transitions(morning: tuple[int, int], moved: int) -> list[Transition]:
        reward = float(income[0][morning[0]] + income[1][morning[1]] - MOVE * abs(moved))
        return [
            (probability, state, reward, False)
            for state, probability in enumerate(following[morning])
            if probability > 0
        ]

    def after(first: int, second: int, action: int) -> list[Transition]:
        moved = cars_moved(first, second, action, cars)
        return transitions((first - moved, second + moved), moved)

    table = [
        [after(first, second, action) for action in range(2 * MAX_MOVED + 1)]
        for first, second in product(range(cars + 1), repeat=2)
    ]
    start = np.zeros(len(table))
    start[cars // 2 * (cars + 1) + cars // 2] = 1.0
    return TabularEnv(table, start)


def cars_moved(first: int, second: int, action: int, cars: int = 20) -> int:
    """Returns the number of cars that an action in fact moves from the first location; negative for moves to it."""
    return max(min(action - MAX_MOVED, first, cars - second), -second, first - cars)


def _day(cars: int, requests: float, returns: float) -> tuple[NDArray[Any], NDArray[Any]]:
    """Returns (morning, evening) probabilities and (morning,) expected income at a location."""
    numbers = np.arange(cars + 1)
    evening = np.zeros((cars + 1, cars + 1))
    rented_mean = np.zeros(cars + 1)
    for morning in numbers:
        rented = _capped(requests, int(morning))
        rented_mean[morning] = RENTAL * float(np.dot(np.arange(morning + 1), rented))
        for count, probability in enumerate(rented):
            left = int(morning) - count
            evening[morning, left:] += probability * _capped(returns, cars - left)
    return evening, rented_mean


def _capped(mean: float, most: int) -> NDArray[Any]:
    """Returns the (most + 1,) probabilities of a Poisson number, with numbers above ``most`` counted as ``most``."""
    below = [math.exp(-mean) * mean**count / math.factorial(count) for count in range(most)]
    return np.array([*below, max(0.0, 1.0 - math.fsum(below))])
