"""The common parts of policy gradient methods, in plain NumPy (Sutton & Barto, 2nd ed., chapter 13)."""

from qtab._utils.checks import required
from qtab.reference.task import Rows, Table, Task


def log_gradient(task: Task, theta: Table, state: Rows, action: int) -> list[float]:
    """Returns the gradient of ln π(A | S) for the preference of each action; it is the same for each active row."""
    temperature = required("temperature", task.config.temperature)
    probabilities = task.policy.probabilities(task.values(theta, state), state)
    return [((other == action) - share) / temperature for other, share in enumerate(probabilities)]


def ascend(task: Task, theta: Table, state: Rows, action: int, scale: float) -> None:
    """Updates θ <- θ + α scale ∇ ln π(A | S, θ); the active rows of S share the step."""
    step = step_size(task) * scale
    gradient = log_gradient(task, theta, state, action)
    task.observer.before_ascent(theta, state, action, step_size(task), gradient, None)
    for row in state:
        for other, part in enumerate(gradient):
            theta[row, other] += step * part
    task.observer.after_ascent(theta)


def step_size(task: Task) -> float:
    """Returns α, divided among the active rows."""
    return float(task.learning_rate.schedule.value) / task.discretizer.n_active


class Critic:
    """State values v(S, w): the sum of the weights of the active rows."""

    def __init__(self, task: Task) -> None:
        # One column for each action, all equal, to store the values in the same shape as the preferences.
        self.w = task.critic_table()
        self.step = required("value_learning_rate", task.config.value_learning_rate) / task.discretizer.n_active

    def value(self, state: Rows) -> float:
        """Returns v(S, w), added from left to right."""
        total = float(self.w[state[0], 0])
        for row in state[1:]:
            total += float(self.w[row, 0])
        return total

    def update(self, state: Rows, error: float) -> None:
        """Updates w <- w + α δ ∇v(S, w)."""
        for row in state:
            self.w[row] += self.step * error
