"""The settings of an estimate: the methods, the options of each, and the checks of their values."""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias, get_args

from qtab._utils import checks
from qtab._utils.fields import with_fields
from qtab._utils.shown import shown
from qtab.config import value_checks as check
from qtab.config.choices import BitGenerator, LearningRateSchedule, OnTruncation
from qtab.config.options import Option
from qtab.prediction.learning_rates import LARGEST, LEAST_SQUARES, applied, checked_learning_rate
from qtab.prediction.linear.lstd import checked_epsilon

Method: TypeAlias = Literal[
    "td",
    "n_step_td",
    "td_lambda",
    "true_online_td_lambda",
    "offline_lambda_return",
    "monte_carlo",
    "importance_sampling",
    "batch_td",
    "off_policy_td",
    "off_policy_td_lambda",
    "gtd2",
    "tdc",
    "emphatic_td",
    "lstd",
]
METHODS: tuple[str, ...] = get_args(Method)
"""The names of the methods."""

OFF_POLICY = ("importance_sampling", "off_policy_td", "off_policy_td_lambda", "gtd2", "tdc", "emphatic_td")
"""The methods that use the importance sampling ratios of a behavior policy."""
NEEDS_BEHAVIOR = OFF_POLICY[:3]
"""The methods that differ from others only with a behavior policy, which must be given."""

_WITH_LAMBDA = ("td_lambda", "true_online_td_lambda", "offline_lambda_return", "off_policy_td_lambda", "lstd")
_OPTIONS: Mapping[str, Option] = {
    "n_steps": Option(check.count, "method", ("n_step_td",), None),
    "trace_decay": Option(check.real(0.0, 1.0), "method", _WITH_LAMBDA, None),
    "second_learning_rate": Option(check.real(0.0, LARGEST), "method", ("gtd2", "tdc"), None),
    "epsilon": Option(checks.finite, "method", ("lstd",), 1e-3),
    "recursive": Option(checks.boolean, "method", ("lstd",), True),
    "first_visit": Option(checks.boolean, "method", ("monte_carlo", "importance_sampling"), False),
    "weighted": Option(checks.boolean, "method", ("importance_sampling",), True),
}
"""The options of the methods; one without a default must be given."""
_DEFAULTS: Mapping[str, Mapping[str, Any]] = {"lstd": {"trace_decay": 0.0}}
"""The defaults of single methods."""


@with_fields
@dataclass(frozen=True)
class PredictionSettings:
    """The settings of an estimate. An option that does not apply to the method is None, and giving it is an error.

    Raises:
        TypeError: for a value of the wrong type.
        ValueError: for a value that is out of range, missing, or does not apply to the method.
    """

    method: Method = "td"
    """The method: td is TD(0), equation 6.2; n_step_td equation 7.2; td_lambda and true_online_td_lambda the boxes in
    sections 12.2 and 12.5; offline_lambda_return equation 12.4; monte_carlo equation 6.1 and the box in section 5.1;
    importance_sampling equations 5.5 and 5.6, off-policy; batch_td section 6.3 (batch Monte Carlo is monte_carlo
    without a learning rate); off_policy_td equation 11.2; off_policy_td_lambda equation 12.25; gtd2 and tdc section
    11.7; emphatic_td section 11.8; lstd section 9.8."""
    episodes: int = 100
    """The number of episodes."""
    learning_rate: float | None = None
    """α: the fraction of the error that an update corrects, in [0, 2], divided among the active features. None means 1
    / n at the n-th visit of a feature, so that Monte Carlo values are averages of returns."""
    learning_rate_schedule: LearningRateSchedule | None = None
    """The schedule of the learning rate: constant, linear or exponential over the episodes, or learning_rate / n at the
    n-th visit of a feature (visits). None means visits without a learning rate, linear with a min_learning_rate or a
    learning_rate_warm_up, otherwise constant."""
    min_learning_rate: float | None = None
    """The lowest learning rate of a schedule, in [0, learning_rate]."""
    learning_rate_decay: float | None = None
    """The factor of the exponential schedule after each episode, in [0, 1]."""
    learning_rate_warm_up: int | None = None
    """The number of episodes before the linear or exponential schedule begins."""
    second_learning_rate: float | None = None
    """β: the step size of the second weight vector of gtd2 and tdc, in [0, 2], constant and divided like the learning
    rate."""
    discount: float = 1.0
    """γ: the discount factor, in [0, 1]."""
    n_steps: int | None = None
    """n: the number of rewards in a target of n_step_td."""
    trace_decay: float | None = None
    """λ: the decay of traces and of λ-returns, in [0, 1]; 0 for lstd unless it is given."""
    first_visit: bool | None = None
    """Whether only the first visit of a state in an episode counts, for monte_carlo and importance_sampling."""
    weighted: bool | None = None
    """Whether importance sampling is weighted (equation 5.6, the default) or ordinary (equation 5.5)."""
    epsilon: float | None = None
    """ε: the matrix A of lstd begins as ε times the identity."""
    recursive: bool | None = None
    """Whether lstd updates A⁻¹ at each step (equation 9.22, the default), or solves equations after each episode."""
    initial_value: float = 0.0
    """The value of every state before the first episode."""
    on_truncation: OnTruncation = "bootstrap"
    """The end of a return at the time limit: it continues with the value of the last state (bootstrap), or ends there
    (terminate)."""
    bit_generator: BitGenerator = "PCG64"
    """The random generator of the policy: PCG64 as in np.random.default_rng, or MT19937 as in np.random.seed."""

    def __post_init__(self) -> None:
        """Checks the values, fills in the defaults of options, and converts NumPy's numbers to Python's."""
        method = checks.choice("method", self.method, METHODS)
        given = vars(self)
        episodes = checks.count("episodes", self.episodes, least=1)
        checked: dict[str, Any] = {
            "method": method,
            "episodes": episodes,
            **checked_learning_rate(method, episodes, given),
            "discount": checks.real("discount", self.discount, 0.0, 1.0),
            "initial_value": checks.finite("initial_value", self.initial_value),
            "on_truncation": checks.choice("on_truncation", self.on_truncation, get_args(OnTruncation)),
            "bit_generator": checks.choice("bit_generator", self.bit_generator, get_args(BitGenerator)),
        }
        if method == LEAST_SQUARES and checked["initial_value"] != 0.0:
            raise ValueError(
                f"initial_value must be 0 for method 'lstd', whose weights follow from the steps, got "
                f"{shown(self.initial_value)}"
            )
        asked = {
            **given,
            **{name: default for name, default in _DEFAULTS.get(method, {}).items() if given[name] is None},
        }
        options = applied(method, _OPTIONS, asked, lambda name, value: _OPTIONS[name].check(name, value))
        if method == LEAST_SQUARES:
            checked_epsilon("epsilon", options["epsilon"], recursive=options["recursive"])
        given.update(checked | options)

    def replace(self, **changes: Any) -> "PredictionSettings":
        """Returns a copy with some settings changed.

        Raises:
            TypeError: for an unknown setting, or a value of the wrong type.
            ValueError: for a value that is out of range or does not apply.
        """
        return dataclasses.replace(self, **changes)

    def method_spec(self) -> dict[str, Any]:
        """Returns the method and its options in the form that the extension reads."""
        options = {name: getattr(self, name) for name, option in _OPTIONS.items() if self.method in option.values}
        return {"type": self.method, **options}

    def config(self) -> dict[str, Any]:
        """Returns the settings of :class:`qtab.Config` for the task, without the learning rate."""
        return {
            "algorithm": "q_learning",
            "episodes": self.episodes,
            "learning_rate": 1.0,
            "learning_rate_schedule": "constant",
            "min_learning_rate": None,
            "learning_rate_decay": None,
            "learning_rate_warm_up": None,
            "discount": self.discount,
            "initial_q": 0.0,
            "terminal_update": "target",
            "on_truncation": self.on_truncation,
            "exploration": "epsilon_greedy",
            "epsilon": 0.0,
            "epsilon_schedule": "constant",
            "bit_generator": self.bit_generator,
            "action_mask": False,
            "count_bonus": 0.0,
            "time_aware": False,
        }
