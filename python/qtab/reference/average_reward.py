"""The average reward of a continuing task (Sutton & Barto, 2nd ed., section 10.3)."""

from qtab.reference.task import Rows, Table, Task, value


class AverageReward:
    """R̄, and the deferred update of an episode's last step, which needs the first state of the next episode."""

    def __init__(self, task: Task, Q: Table, step_size: float) -> None:
        self.task, self.Q, self.step_size = task, Q, step_size
        self.value = 0.0
        self.waiting: tuple[Rows, int, float] | None = None

    def learn(self, state: Rows, action: int, reward: float, following: float) -> None:
        """Updates by δ = R - R̄ + following - Q(S, A): R̄ <- R̄ + β δ, Q(S, A) <- Q(S, A) + α δ."""
        target = (reward - self.value) + following
        # Before the first step of an episode, this updates the last step of the previous episode.
        self.task.observer.target(self.task.step_number, (reward,), following)
        self.task.observer.average_reward(self.value)
        self.value += self.step_size * (target - value(self.Q, state, action))
        self.task.update(self.Q, state, action, target)

    def begin_episode(self, following: float) -> None:
        """Applies the deferred update: a reset counts as a transition from the terminal state, without a step."""
        if self.waiting is not None:
            self.learn(*self.waiting, following)
            self.waiting = None
