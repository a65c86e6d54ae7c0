"""The records of each step in an explanation: the choice of the action, the updates, the traces."""

from dataclasses import dataclass
from typing import Any, Literal

from qtab._utils import html
from qtab.explanation.policy_update import PolicyUpdate

Reason = Literal["greedy", "tie broken", "explored", "exploring start", "softmax", "upper bound"]


@dataclass(frozen=True)
class Choice:
    """An action, and the reason why it was chosen."""

    action: int
    """The column of the action in the table."""
    reason: Reason
    """``"greedy"``: it has the largest value. ``"tie broken"``: several have. ``"explored"``: drawn at random, as
    happens with probability epsilon. ``"softmax"``: drawn with the probabilities of the softmax policy.
    ``"upper bound"``: it has the largest upper confidence bound. ``"exploring start"``: drawn as the first action of an
    episode."""
    values: tuple[float, ...]
    """(actions,): the values that the policy compared; the sum of both tables for Double Q-learning, the bounds for
    upper confidence bounds."""
    probability: float
    """The probability with which the policy chooses this action."""
    drawn: float
    """The random number in [0, 1) that decided; NaN for upper confidence bounds and exploring starts, which compare
    none."""
    tied: int
    """The number of actions with the largest value."""
    epsilon: float | None
    """The exploration rate; None for other policies than epsilon-greedy."""
    temperature: float | None
    """The temperature of softmax; None for other policies than softmax."""
    random_ties: bool
    """Whether ties are broken at random, instead of for the first action."""

    def __str__(self) -> str:
        if self.reason == "upper bound":
            chosen = f"upper bound: Q + c √(ln t / N) = {self.values[self.action]:.6g} is the largest"
            how = "a random one" if self.random_ties else "the first"
            return chosen if self.tied == 1 else f"{chosen}, {how} of {self.tied}"
        if self.reason == "exploring start":
            return f"exploring start: drawn with probability {self.probability:.3g}"
        if self.epsilon is None:
            return f"softmax: drawn with probability {self.probability:.3g} at temperature {self.temperature:.6g}"
        drawn, limit = _told_apart(self.drawn, 1.0 - self.epsilon)
        if self.reason == "explored":
            return f"explored: drawn at random, as {drawn} >= 1 - epsilon = {limit}"
        below = f"{drawn} < 1 - epsilon = {limit}"
        if self.reason == "greedy":
            return f"greedy: the largest of {len(self.values)} values, as {below}"
        how = "drawn from" if self.random_ties else "the first of"
        return f"tie broken: {how} {self.tied} actions with the largest value, as {below}"


def _told_apart(one: float, other: float) -> tuple[str, str]:
    """Formats two numbers with the fewest digits, at least three, that show which one is smaller."""
    for digits in range(3, 17):
        shown = f"{one:.{digits}g}", f"{other:.{digits}g}"
        if (float(shown[0]) < float(shown[1])) == (one < other):
            return shown
    return repr(one), repr(other)


@dataclass(frozen=True)
class Update:
    """A change of Q(S, A) towards a target. Its numbers are exact: they give the table bit for bit."""

    step: int | None
    """The step of S and A, counted from 0 in the episode: for n-step methods an earlier one. -1 is the last step of the
    previous episode, which differential methods update when the next one begins. None in planning."""
    table: int
    """The number of the table that changed: 0, or 1 for the second one of Double Q-learning."""
    rows: tuple[int, ...]
    """(n_active,): the active rows of S."""
    cell: tuple[int, ...] | None
    """The cell of S; None with tile coding, which has no cells."""
    action: int
    """The column of A."""
    rewards: tuple[float, ...]
    """The rewards in the target, with their count bonuses: one, or up to n for n-step Sarsa. In planning, that of
    Dyna-Q+ includes the bonus for the time since the last try: R + κ √τ."""
    bootstrap: float | None
    """The value of the next state in the target, or for Monte Carlo methods the return from the next step on; None
    if the next state is terminal."""
    target: float
    error: float
    """The TD error: the target minus ``before``."""
    step_sizes: tuple[float, ...]
    """(n_active,): the learning rate of each weight; empty if the target was assigned."""
    traces: tuple[float, ...]
    """(n_active,): the eligibility trace of each weight; empty for algorithms without traces."""
    old_value: float | None
    """Q_old of true online Sarsa(lambda): the value of S and A before the last update. None for others."""
    average_reward: float | None
    """The average reward in the target of a differential method, (R - average reward) + bootstrap. None for others."""
    before: float
    """Q(S, A) before the update: the sum of ``weights_before``, each times its feature."""
    after: float
    """Q(S, A) after it: the sum of ``weights_after``, each times its feature."""
    weights_before: tuple[float, ...]
    """(n_active,): the values of the active rows before the update."""
    weights_after: tuple[float, ...]
    """(n_active,): the values of the active rows after it."""
    equations: tuple[str, ...]
    """The equations of the update."""
    numbers: tuple[str, ...]
    """The same equations with their numbers, rounded to six digits."""
    state: str = ""
    """S in words, for planning updates; empty for others, whose state is that of their step."""
    action_name: str = ""
    """The name of A, for planning updates."""
    features: tuple[float, ...] = ()
    """(n_active,): the features x of S, which multiply the weights; empty if each is 1."""

    @property
    def assigned(self) -> bool:
        """Whether the target was assigned, as the article does at a terminal state."""
        return not self.step_sizes


@dataclass(frozen=True)
class Trace:
    """The eligibility trace of a value, and how the step changed that value."""

    row: int
    cell: tuple[int, ...] | None
    action: int
    trace: float
    before: float
    after: float
    state: str = ""
    """The state in words: a place on a map, or the bounds of its cell."""
    action_name: str = ""


@dataclass(frozen=True)
class ExplainedStep:
    """A step of an episode: the observation, the action and the updates."""

    step: int
    """The number of the step, from 0."""
    observation: Any
    rows: tuple[int, ...]
    """(n_active,): the active rows of the observation."""
    cell: tuple[int, ...] | None
    """The cell of the observation; None with tile coding, which has no cells."""
    state: str
    """The observation in words."""
    action: Any
    """The action as ``env.step`` takes it."""
    action_name: str
    choice: Choice
    """The choice of the action, with its reason."""
    reward: float
    """The reward of the environment."""
    bonus: float
    """The count bonus, which the learner adds to the reward: R in the equations is their sum. 0 without one."""
    next_observation: Any
    next_rows: tuple[int, ...]
    next_cell: tuple[int, ...] | None
    next_state: str
    """The next observation in words."""
    terminated: bool
    truncated: bool
    terminal: bool
    """Whether the learner treated the next state as terminal: it is, or the time limit ended the episode with
    ``on_truncation="terminate"``."""
    updates: tuple[Update, ...]
    """The updates that followed the step: one; for n-step methods none at first and several at the end of the episode.
    For Monte Carlo methods the update of this step, if it has one: they are made after the episode, from its last step
    to its first."""
    policy_updates: tuple[PolicyUpdate, ...]
    """The update of a policy gradient method, which changes the preferences of the step's state. REINFORCE makes its
    updates after the episode, from its first step to its last."""
    planning: tuple[Update, ...]
    """The planning updates of Dyna-Q and Dyna-Q+ and those of prioritized sweeping, in order."""
    traces: tuple[Trace, ...]
    """The largest eligibility traces when the values changed, at most eight."""
    n_traces: int
    """The number of values with a trace, all of which changed."""
    pending: tuple[int, ...]
    """The steps that an n-step method has not updated yet."""
    future_return: float | None
    """G: the discounted rewards from this step on, for Monte Carlo methods and REINFORCE; None for others, and with
    off-policy Monte Carlo control before the last action that is not greedy."""
    note: str
    """The reason why no value changed; empty if one did."""
    action_names: tuple[str, ...] = ()
    """The names of all actions, in the order of ``choice.values``."""
    features: tuple[float, ...] = ()
    """(n_active,): the features of the observation, if they are weighted; else empty, because each is 1."""
    next_features: tuple[float, ...] = ()
    """(n_active,): the features of the next observation, if they are weighted."""

    @property
    def reward_text(self) -> str:
        """The reward as text, with R if a count bonus makes it differ from the reward."""
        if not self.bonus:
            return f"{self.reward:.6g}"
        bonus = f"({self.bonus:.6g})" if self.bonus < 0 else f"{self.bonus:.6g}"
        return (
            f"{self.reward:.6g}, with the count bonus R = {self.reward:.6g} + {bonus} = {self.reward + self.bonus:.6g}"
        )

    def _repr_html_(self) -> str:
        """HTML for notebooks: the step as a table."""
        rows: list[tuple[str, object]] = [
            ("state", self.state),
            ("action", self.action_name),
            ("why", self.choice),
            ("reward", self.reward_text),
            ("next state", self.next_state + (", terminal" if self.terminated else "")),
        ]
        for update in self.updates:
            equations = zip(update.equations, update.numbers, strict=True)
            rows.append(("update", "\n".join(f"{symbols}\n{numbers}" for symbols, numbers in equations)))
            rows.append(("value", f"{update.before:.6g} -> {update.after:.6g}, TD error {update.error:.6g}"))
        for change in self.policy_updates:
            equations = zip(change.equations, change.numbers, strict=True)
            rows.append(("update", "\n".join(f"{symbols}\n{numbers}" for symbols, numbers in equations)))
            rows.append(("policy", change.policy))
        return html.sentences(f"Step {self.step}", (), rows)

    @property
    def first_update(self) -> Update | None:
        """The first update that does not belong to the previous episode; None if there is none."""
        return next((update for update in self.updates if update.step != -1), None)

    @property
    def target(self) -> float | None:
        """The target of the first update; None without an update."""
        return None if self.first_update is None else self.first_update.target

    @property
    def td_error(self) -> float | None:
        """The TD error of the first update; None without an update."""
        return None if self.first_update is None else self.first_update.error

    @property
    def before(self) -> float | None:
        """The value before the first update; None without an update."""
        return None if self.first_update is None else self.first_update.before

    @property
    def after(self) -> float | None:
        """The value after the first update; None without an update."""
        return None if self.first_update is None else self.first_update.after
