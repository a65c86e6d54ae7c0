"""``qtab/RandomWalk-v0``: the random walks of Sutton & Barto, 2nd ed., Examples 6.2, 7.1 and 9.1."""

from qtab._utils import checks
from qtab.envs.tabular import TabularEnv, Transition

LEFT, RIGHT = range(2)
ACTION_NAMES = ("left", "right")


class RandomWalkEnv(TabularEnv):
    """States in a row, left to right. Episodes start in the middle and end beyond the first or the last state.

    The actions are left (0) and right (1). Under the policy ``"random"`` it is the book's Markov reward process: five
    states with rewards 0 and 1 at the ends (Example 6.2), 19 with -1 and 1 (Example 7.1), or 1,000 with -1 and 1 where
    a step leads to any of the 100 neighbors on its side (Example 9.1). With an even number of states, the start is the
    left one of the two in the middle.

    Args:
        states: The number of states, without the terminal ones.
        reach: The number of neighbors on each side to which a step leads with equal probability; those beyond the ends
            are terminal.
        left_reward: The reward of a step beyond the first state.
        right_reward: The reward of a step beyond the last state.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument below 1, or a reward that is not finite.
    """

    def __init__(self, states: int = 19, reach: int = 1, left_reward: float = -1.0, right_reward: float = 1.0) -> None:
        self.states = checks.integer("states", states, least=1)
        self.reach = checks.integer("reach", reach, least=1)
        self.left_reward = checks.finite("left_reward", left_reward)
        self.right_reward = checks.finite("right_reward", right_reward)
        start = (self.states - 1) // 2
        table = [[self._row(state, action) for action in (LEFT, RIGHT)] for state in range(self.states)]
        super().__init__(table, [float(state == start) for state in range(self.states)])

    def _row(self, state: int, action: int) -> list[Transition]:
        """Returns the transitions of an action: the neighbors in ascending order of their distance, then the end."""
        room = state if action == LEFT else self.states - 1 - state
        near = min(self.reach, room)
        sign = -1 if action == LEFT else 1
        row: list[Transition] = [
            (1.0 / self.reach, state + sign * distance, 0.0, False) for distance in range(1, near + 1)
        ]
        if near < self.reach:
            reward = self.left_reward if action == LEFT else self.right_reward
            # The next state of a last step is the nearest existing one.
            end = 0 if action == LEFT else self.states - 1
            row.append(((self.reach - near) / self.reach, end, reward, True))
        return row
