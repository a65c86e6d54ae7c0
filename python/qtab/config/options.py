"""The table of settings: for each its check, where it applies, its default there, and its other names.

The fields of :class:`qtab.Config` have the types, the explanations, and the defaults of the settings that always apply.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from qtab._utils import checks
from qtab.config import value_checks as check
from qtab.config.choices import CHOICES, FUNCTION, MAPPING
from qtab.config.functions import mask_setting
from qtab.config.value_checks import Check


@dataclass(frozen=True)
class Setting:
    """A setting of a run."""

    check: Check
    """The check of its value."""
    other_names: str = field(default="", kw_only=True)
    """Its names in other libraries and textbooks, separated by spaces."""
    may_be_none: bool = field(default=False, kw_only=True)
    """Whether None means "not given" and is not checked."""
    added: bool = field(default=False, kw_only=True)
    """Whether earlier versions lack it: files store it only if it differs from its default."""


@dataclass(frozen=True)
class Option(Setting):
    """A setting that applies only for some values of another setting, such as the trace decay of Sarsa(λ)."""

    choice: str
    """The other setting."""
    values: tuple[str, ...]
    """The values of the other setting for which this one applies."""
    default: Any
    """The default where it applies. None if there is no default, or it is derived from the observation space."""
    off_by_none: bool = field(default=False, kw_only=True)
    """Whether None is a real value, not just "not set"."""
    may_be_none: bool = field(default=True, kw_only=True)


@dataclass(frozen=True)
class Fixed:
    """Settings with a single possible value for an algorithm, which would ignore any other."""

    values: Mapping[str, Any]
    """The value of each of these settings."""
    reason: str
    """The reason, for messages: it follows "for algorithm ..., which"."""


_WITH_TRACES = ("sarsa_lambda", "watkins_q_lambda")
_WITH_TARGET_POLICY = ("n_step_tree_backup", "n_step_q_sigma")
_FALLING = ("linear", "exponential")
WITH_STATE_VALUES = ("reinforce_with_baseline", "actor_critic", "actor_critic_lambda")
"""The algorithms that learn state values besides a policy: a second table, with the value of a row in every column."""
PREFERENCES = ("gradient_bandit", "reinforce", *WITH_STATE_VALUES)
"""The algorithms whose table holds preferences instead of action values. Their policy is the softmax of the
preferences."""

WITH_PROBABILITIES = ("off_policy_monte_carlo", *_WITH_TARGET_POLICY)
"""The algorithms that learn from the probabilities of the actions."""
AVERAGE_REWARD = ("differential_sarsa", "differential_q_learning")
"""The algorithms that learn the average reward, without a discount."""
MONTE_CARLO = ("monte_carlo", "monte_carlo_es", "off_policy_monte_carlo")
"""The algorithms that learn from the returns of whole episodes."""

_RETURNS_ALONE = Fixed({"on_truncation": "terminate"}, "learns from the rewards of an episode alone")
FIXED: Mapping[str, Fixed] = {
    **dict.fromkeys(AVERAGE_REWARD, Fixed({"discount": 1.0}, "learns the average reward")),
    "gradient_bandit": Fixed({"discount": 0.0, "on_truncation": "terminate"}, "learns from the next reward alone"),
    "reinforce": _RETURNS_ALONE,
    "reinforce_with_baseline": _RETURNS_ALONE,
}
"""The algorithms for which some settings are fixed."""

ONE_STEP = (
    "q_learning",
    "sarsa",
    "expected_sarsa",
    "double_q_learning",
    "dyna_q",
    "dyna_q_plus",
    "prioritized_sweeping",
)
"""The algorithms that can assign the reward as the value at a terminal state, as the article does, if they learn a
table."""
TABLES_ONLY = ("dyna_q", "dyna_q_plus", *MONTE_CARLO, "prioritized_sweeping", "gradient_bandit")
"""The algorithms that work with neither tile coding nor weighted features."""
WEIGHTED = ("fourier", "polynomial", "radial", "coarse")
"""The discretizers with weighted features: each row of the table has a number for an observation."""
LEARNS_WEIGHTED = tuple(name for name in CHOICES["algorithm"] if name not in TABLES_ONLY)
"""The algorithms that learn with weighted features."""
DEFAULTS_OF_WEIGHTED: Mapping[str, Any] = {"traces": "accumulating", "value_learning_rate": 0.005}
"""The defaults of options that differ with weighted features."""
DEFAULTS_OF_NORMALIZED: Mapping[str, Any] = {"traces": "accumulating"}
"""The same for features that sum to 1."""
NO_MASKED_TILES = (*PREFERENCES, *_WITH_TARGET_POLICY)
"""The algorithms that do not work with action masks and tile coding together.

They update a state after seeing the next one, and only the mask of the last state is known.
"""


# A choice comes before the options that depend on it.
SETTINGS: Mapping[str, Setting] = {
    "env": Setting(check.text, other_names="env_id env_name environment"),
    "env_kwargs": Setting(check.keywords, other_names="environment_kwargs make_kwargs"),
    "max_episode_steps": Setting(
        check.count, other_names="max_steps max_steps_per_episode time_limit horizon", may_be_none=True
    ),
    "time_aware": Setting(checks.boolean, added=True),
    "backend": Setting(check.choice),
    "episodes": Setting(check.count, other_names="n_episodes num_episodes max_episodes total_episodes n_eps"),
    "seed": Setting(check.integer(0), other_names="random_seed random_state rng", may_be_none=True),
    "bit_generator": Setting(check.choice),
    "preset": Setting(check.text, may_be_none=True),
    "algorithm": Setting(check.choice, other_names="algo agent method"),
    "learning_rate": Setting(checks.finite, other_names="alpha lr step_size stepsize"),
    "discount": Setting(check.real(0, 1), other_names="gamma discount_factor discount_rate"),
    "learning_rate_schedule": Setting(check.choice, other_names="alpha_schedule lr_schedule"),
    "min_learning_rate": Option(
        check.not_negative,
        "learning_rate_schedule",
        (*_FALLING, "visits"),
        0.0,
        other_names="alpha_min min_alpha min_lr lr_min",
    ),
    "learning_rate_decay": Option(
        check.real(0, 1), "learning_rate_schedule", ("exponential",), 0.999, other_names="alpha_decay lr_decay"
    ),
    "learning_rate_warm_up": Option(check.integer(0, checks.LARGEST_COUNT), "learning_rate_schedule", _FALLING, 0),
    "trace_decay": Option(
        check.real(0, 1),
        "algorithm",
        (*_WITH_TRACES, "true_online_sarsa_lambda", "actor_critic_lambda"),
        0.9,
        other_names="lam lambda_ lambd lmbda td_lambda",
    ),
    "traces": Option(check.choice, "algorithm", _WITH_TRACES, "replacing", other_names="trace_type eligibility_traces"),
    "trace_cutoff": Option(check.real(0, 1), "algorithm", (*_WITH_TRACES, "true_online_sarsa_lambda"), 0.0),
    "n_steps": Option(
        check.integer(1, 1_000_000), "algorithm", ("n_step_sarsa", *_WITH_TARGET_POLICY), 4, other_names="n n_step"
    ),
    "sigma": Option(check.real(0, 1), "algorithm", ("n_step_q_sigma",), 0.5, other_names="sampling_degree", added=True),
    "target_policy": Option(check.choice, "algorithm", _WITH_TARGET_POLICY, "greedy", added=True),
    "planning_steps": Option(
        check.integer(0, 1_000_000),
        "algorithm",
        ("dyna_q", "dyna_q_plus", "prioritized_sweeping"),
        10,
        other_names="n_planning n_planning_steps planning",
    ),
    "time_weight": Option(check.not_negative, "algorithm", ("dyna_q_plus",), 1e-3, other_names="kappa"),
    "model": Option(check.choice, "algorithm", ("dyna_q",), "deterministic", added=True),
    "priority_threshold": Option(
        check.not_negative,
        "algorithm",
        ("prioritized_sweeping",),
        1e-4,
        other_names="theta priority_tolerance",
        added=True,
    ),
    "reward_learning_rate": Option(
        check.real(0, 1),
        "algorithm",
        AVERAGE_REWARD,
        0.01,
        other_names="beta eta average_reward_rate reward_step_size",
        added=True,
    ),
    "baseline": Option(checks.boolean, "algorithm", ("gradient_bandit",), True, added=True),
    "value_learning_rate": Option(
        checks.finite,
        "algorithm",
        WITH_STATE_VALUES,
        0.1,
        other_names="alpha_w critic_learning_rate critic_lr value_lr",
        added=True,
    ),
    "initial_q": Setting(check.initial_q, other_names="init_q q_init q_table initial_value optimistic_value"),
    "terminal_update": Setting(check.choice),
    "on_truncation": Setting(check.choice),
    "exploration": Setting(
        check.choice, other_names="policy policy_type behaviour_policy behavior_policy policy_kwargs"
    ),
    "epsilon": Option(
        check.real(0, 1),
        "exploration",
        ("epsilon_greedy",),
        0.8,
        other_names="eps exploration_rate epsilon_start eps_start exploration_initial_eps",
    ),
    "epsilon_schedule": Option(check.choice, "exploration", ("epsilon_greedy",), "linear"),
    "min_epsilon": Option(
        check.real(0, 1),
        "epsilon_schedule",
        _FALLING,
        0.0,
        other_names="epsilon_min epsilon_end eps_min eps_end exploration_final_eps final_epsilon",
    ),
    "epsilon_decay": Option(
        check.real(0, 1), "epsilon_schedule", ("exponential",), 0.999, other_names="eps_decay exploration_decay"
    ),
    "epsilon_warm_up": Option(check.integer(0, checks.LARGEST_COUNT), "epsilon_schedule", _FALLING, 0),
    "ties": Option(
        check.choice, "exploration", ("epsilon_greedy", "ucb"), "first", other_names="tie_breaking tie_break"
    ),
    "temperature": Option(check.above_zero, "exploration", ("softmax",), 1.0, other_names="tau"),
    "confidence": Option(check.not_negative, "exploration", ("ucb",), 2.0, other_names="ucb_c c ucb", added=True),
    "count_bonus": Setting(check.not_negative, other_names="exploration_bonus bonus count_based_bonus", added=True),
    "action_mask": Setting(mask_setting, added=True),
    "shape": Option(check.counts(1, checks.LARGEST_COUNT), "discretizer", (FUNCTION,), None, added=True),
    "max_rows": Option(
        check.integer(1, check.MAX_ROWS),
        "discretizer",
        ("round", "bins", "edges", "identity", FUNCTION, MAPPING),
        None,
        off_by_none=True,
        added=True,
    ),
    "scale": Option(check.scale, "discretizer", ("round",), None, may_be_none=False),
    "tilings": Option(
        check.integer(1, check.MAX_TILINGS), "discretizer", ("tiles",), 8, other_names="n_tilings num_tilings"
    ),
    "tiles": Option(
        check.counts(1, check.MAX_TILES), "discretizer", ("tiles",), (8,), other_names="n_tiles num_tiles tiles_per_dim"
    ),
    "hashed_rows": Option(
        check.integer(1, 2**32 - 1),
        "discretizer",
        ("tiles",),
        None,
        other_names="iht_size hash_size memory_size",
        off_by_none=True,
    ),
    "bins": Option(
        check.counts(1, check.MAX_BINS), "discretizer", ("bins",), (10,), other_names="n_bins num_bins buckets"
    ),
    "edges": Option(check.edges, "discretizer", ("edges",), None),
    "order": Option(check.order, "discretizer", ("fourier", "polynomial"), 3, other_names="degree", added=True),
    "coupled": Option(checks.boolean, "discretizer", ("fourier", "polynomial"), True, added=True),
    "scale_step_sizes": Option(checks.boolean, "discretizer", ("fourier",), True, added=True),
    "centers": Option(check.counts(2, check.MAX_FEATURES), "discretizer", ("radial", "coarse"), (5,), added=True),
    "width": Option(
        check.sizes(0.1, 1000), "discretizer", ("radial",), (1.0,), other_names="sigma std_dev", added=True
    ),
    "normalized": Option(checks.boolean, "discretizer", ("radial",), False, other_names="normalize", added=True),
    "radius": Option(check.sizes(0.5, 1e4), "discretizer", ("coarse",), (1.5,), added=True),
    "low": Option(check.each, "discretizer", ("bins", "tiles", *WEIGHTED), None),
    "high": Option(check.each, "discretizer", ("bins", "tiles", *WEIGHTED), None),
    "actions": Setting(check.actions, other_names="n_actions num_actions", may_be_none=True),
}
"""Every setting except ``discretizer``, whose check also needs its options; see ``checked_discretizer``."""
OPTIONS: Mapping[str, Option] = {name: setting for name, setting in SETTINGS.items() if isinstance(setting, Option)}
"""The settings that apply only to certain choices."""
OFF_BY_NONE = tuple(name for name, option in OPTIONS.items() if option.off_by_none)
"""The options for which None is a real value, not just "not set"."""


def options_of(choice: str, value: str) -> list[str]:
    """Returns the names of the options that apply to a value of a choice, such as an algorithm."""
    return [name for name, option in OPTIONS.items() if option.choice == choice and value in option.values]


def n_tables(algorithm: str) -> int:
    """Returns the number of tables that an algorithm learns."""
    return 2 if algorithm in ("double_q_learning", *WITH_STATE_VALUES) else 1


def fixed_settings(algorithm: Any) -> Mapping[str, Any]:
    """Returns the settings with a single possible value for an algorithm; empty for an unknown ``algorithm``."""
    return FIXED[algorithm].values if isinstance(algorithm, str) and algorithm in FIXED else {}


def freed_settings(before: Any, now: Any) -> set[str]:
    """Returns the names of the settings that were fixed for the previous algorithm, and are not for the new one."""
    return fixed_settings(before).keys() - fixed_settings(now).keys()


def is_set(value: Any) -> bool:
    """Returns whether a setting has a value. None and an empty scale mean "not given"."""
    return value is not None and not (isinstance(value, tuple) and not value)
