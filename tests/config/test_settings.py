"""The settings are defined once: types as given, as stored, choices, checks, signatures and help texts agree."""

import dataclasses
import inspect
from collections.abc import Callable
from types import NoneType
from typing import Any, Literal, get_args, get_origin, get_type_hints

import pytest

import qtab
from qtab import _core
from qtab.config import DEFAULTS, choices
from qtab.config.choices import FUNCTION, MAPPING
from qtab.config.help import explanations, groups
from qtab.config.options import OPTIONS, SETTINGS
from qtab.config.settings import ConfigSettings, Settings, SharedSettings

STORED = get_type_hints(qtab.Config)
GIVEN = get_type_hints(ConfigSettings)
FUNCTIONS = {qtab.train: Settings, qtab.train_many: SharedSettings, qtab.sweep: SharedSettings}


def may_be_none(type_: object) -> bool:
    return NoneType in get_args(type_)


def literal(type_: object) -> tuple[str, ...]:
    parts = [type_, *get_args(type_)]
    return next((get_args(part) for part in parts if get_origin(part) is Literal), ())


def test_what_may_be_given_is_what_is_stored() -> None:
    assert GIVEN.keys() == STORED.keys()
    assert {name for name in GIVEN if may_be_none(GIVEN[name])} == {
        name for name in STORED if may_be_none(STORED[name])
    }
    assert {name: literal(GIVEN[name]) for name in GIVEN} == {name: literal(STORED[name]) for name in STORED}


def test_every_choice_is_in_the_table_of_choices() -> None:
    assert {name: literal(type_) for name, type_ in STORED.items() if literal(type_)} == choices.CHOICES


def test_every_setting_is_checked() -> None:
    assert list(SETTINGS) == [name for name in STORED if name != "discretizer"]
    may_not_be_given = {name for name, setting in SETTINGS.items() if setting.may_be_none}
    assert may_not_be_given == {name for name in STORED if may_be_none(STORED[name])}


def test_the_options_are_the_settings_that_are_not_given_by_default() -> None:
    not_given = {name for name, default in DEFAULTS.items() if default is None or default == ()}
    assert OPTIONS.keys() == not_given - {"max_episode_steps", "seed", "preset", "actions"}
    for option in OPTIONS.values():
        assert set(option.values) <= {*choices.CHOICES[option.choice], FUNCTION, MAPPING}


def test_rust_knows_the_same_algorithms_discretizers_and_schedules() -> None:
    assert set(_core.ALGORITHMS) == set(get_args(choices.Algorithm))
    # Rust takes the edges themselves for "edges" as for "bins", and several discretizers together as "product".
    assert {*_core.DISCRETIZERS, "edges"} - {"product"} == set(get_args(choices.DiscretizerName))
    assert set(_core.SCHEDULES) == set(get_args(choices.LearningRateSchedule))
    assert {*get_args(choices.EpsilonSchedule), "visits"} == set(_core.SCHEDULES)


def test_every_setting_is_explained_in_its_group() -> None:
    assert explanations().keys() == STORED.keys()
    grouped = groups(STORED)
    assert list(grouped) == ["Environment", "Run", "Learning", "Exploration", "Discretizer"]
    assert [name for names in grouped.values() for name in names] == [
        field.name for field in dataclasses.fields(qtab.Config)
    ]


@pytest.mark.parametrize("function", FUNCTIONS, ids=lambda function: function.__name__)
def test_a_signature_shows_every_setting_with_its_type_and_default(function: Callable[..., Any]) -> None:
    parameters = inspect.signature(function).parameters
    assert all(parameter.kind is not parameter.VAR_KEYWORD for parameter in parameters.values())
    types = get_type_hints(FUNCTIONS[function])
    for name, type_ in types.items():
        parameter = parameters[name]
        assert parameter.kind is parameter.KEYWORD_ONLY
        assert parameter.annotation == type_
        assert f"\n    {name}: " in str(function.__doc__)
    assert (parameters["epsilon"].default, parameters["trace_decay"].default) == (0.8, 0.9)
    assert (parameters["learning_rate"].default, parameters["scale"].default) == (0.2, ())
    assert str(parameters["learning_rate"]) == "learning_rate: float = 0.2"
    assert ("seed" in parameters) == (function is qtab.train)


def test_the_docstring_explains_a_setting_as_the_config_does() -> None:
    words = " ".join(str(qtab.train.__doc__).split())
    assert "discount: γ: the discount factor, in [0, 1]." in words
    n_step = "'n_step_sarsa', 'n_step_tree_backup' or 'n_step_q_sigma'"
    assert f"n_steps: n: the number of rewards in a target. Applies to algorithm {n_step}." in words
