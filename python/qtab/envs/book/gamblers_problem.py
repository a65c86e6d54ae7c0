"""The gambler's problem of Sutton & Barto's book (Example 4.3) as a transition table."""

from qtab._utils import checks
from qtab.envs.tabular import TabularEnv, Transition


def gamblers_problem(probability: float = 0.4, goal: int = 100) -> TabularEnv:
    """Returns the gambler's problem: bets on the flips of a coin, until the gambler has the goal or nothing.

    A state is the capital, from 0 to the goal. Action a stakes a + 1, or less if the gambler has less or needs less to
    reach the goal. If the coin comes up heads, the stake is won, otherwise it is lost. The reward is 1 at the goal and
    0 otherwise, so that a value without a discount is the probability of winning. An episode starts with any capital
    between the two ends, each with the same probability.

    Args:
        probability: The probability of heads.
        goal: The capital at which the gambler wins, at least 2.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for one out of range.
    """
    probability = checks.real("probability", probability, 0.0, 1.0)
    goal = checks.integer("goal", goal, least=2)

    def transitions(capital: int, action: int) -> list[Transition]:
        if capital in (0, goal):
            return [(1.0, capital, 0.0, True)]
        stake = min(action + 1, capital, goal - capital)
        won, lost = capital + stake, capital - stake
        return [
            (probability, won, float(won == goal), won == goal),
            (1.0 - probability, lost, 0.0, lost == 0),
        ]

    table = [[transitions(capital, action) for action in range(goal // 2)] for capital in range(goal + 1)]
    start = [0.0, *[1 / (goal - 1)] * (goal - 1), 0.0]
    return TabularEnv(table, start)
