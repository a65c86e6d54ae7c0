"""The spec of a run has the same choices in Python and in Rust."""

from typing import Any, get_args, get_type_hints

import pytest

import qtab
from qtab import _core, _spec
from qtab.config import choices
from qtab.config.options import options_of
from qtab.discretizers import DISCRETIZERS
from qtab.training.setup.resolve import resolve


def words(union: Any) -> set[str]:
    """Returns the tags of a union of typed dictionaries."""
    return {word for member in get_args(union) for word in tags(member)}


def tags(member: Any) -> tuple[str, ...]:
    """Returns the tags of one typed dictionary."""
    return get_args(get_type_hints(member)["type"])


def test_the_algorithms_are_the_same_in_rust() -> None:
    assert set(_core.ALGORITHMS) == set(get_args(choices.Algorithm))


@pytest.mark.parametrize("algorithm", get_args(choices.Algorithm))
def test_the_extension_takes_every_algorithm_with_the_options_of_the_table(algorithm: choices.Algorithm) -> None:
    spec: Any = resolve("FrozenLake-v1", {"algorithm": algorithm, "discretizer": "identity"}).spec()
    _core.Trainer(spec, 0)
    for option in options_of("algorithm", algorithm):
        incomplete: Any = {**spec, "settings": {**spec["settings"], option: None}}
        with pytest.raises(ValueError, match=f"^{option} must be given$"):
            _core.Trainer(incomplete, 0)


def test_the_discretizers_are_the_same_but_for_edges_sent_as_bins_and_several_sent_as_a_product() -> None:
    assert set(_core.DISCRETIZERS) == words(_spec.DiscretizerSpec)
    assert set(DISCRETIZERS) == set(get_args(choices.DiscretizerName)) == {*_core.DISCRETIZERS, "edges"} - {"product"}


def test_the_schedules_are_the_same_and_epsilon_has_none_by_visits() -> None:
    assert set(_core.SCHEDULES) == set(get_args(choices.LearningRateSchedule))
    assert set(get_args(choices.EpsilonSchedule)) == set(_core.SCHEDULES) - {"visits"}


def spec_with(path: str, value: Any) -> Any:
    spec: Any = resolve("MountainCar-v0", {"seed": 0, "episodes": 5}).spec()
    *parents, name = path.split(".")
    inner = spec
    for parent in parents:
        inner[parent] = dict(inner[parent])
        inner = inner[parent]
    if value is None:
        del inner[name]
    else:
        inner[name] = value
    return spec


@pytest.mark.parametrize(
    ("path", "value", "error", "message"),
    [
        ("settings.algorithm", "qlearning", ValueError, r"^algorithm must be 'q_learning' or .*, got 'qlearning'$"),
        ("discretizer.type", 3, ValueError, r"^discretizer\.type must be 'round' or 'bins' or .*, got 3$"),
        (
            "settings.epsilon_schedule",
            "visits",
            ValueError,
            r"^epsilon_schedule must be .*'exponential', got 'visits'$",
        ),
        ("settings.epsilon", "much", ValueError, r"^epsilon must be a number in \[0, 1\], got 'much'$"),
        ("settings.epsilon_warm_up", 5, ValueError, r"^epsilon_warm_up must be an integer from 0 to 4, got 5$"),
        ("settings.learning_rate", None, ValueError, r"^learning_rate must be given$"),
        ("settings.episodes", 0, ValueError, r"^episodes must be an integer from 1 to \d+, got 0$"),
        ("discretizer.low", [1.0], ValueError, r"^discretizer\.low must be a list of length 2, got length 1$"),
        ("settings.bit_generator", "Philox", ValueError, r"^bit_generator must be 'PCG64' or 'MT19937', got 'Philox'$"),
        ("env.type", "remote", ValueError, r"^env\.type must be 'native' or 'python', got 'remote'$"),
        ("env", 7, TypeError, r"^env must be a dict, got 7$"),
        ("num_actions", 2, ValueError, r"^num_actions must be 3, the environment's, got 2$"),
    ],
)
def test_a_spec_that_does_not_fit_is_refused_by_the_path_of_the_field(
    path: str, value: Any, error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        _core.Trainer(spec_with(path, value), 0)


def test_a_spec_is_a_dict() -> None:
    with pytest.raises(TypeError, match=r"^spec must be a dict, got None$"):
        _core.Trainer(None, 0)  # type: ignore[arg-type]


def test_a_spec_trains_what_train_trains() -> None:
    trainer = _core.Trainer(spec_with("episodes", 5), 0)
    trainer.advance(5)
    run = qtab.train("MountainCar-v0", seed=0, episodes=5)
    assert trainer.tables().tobytes() == run.tables.tobytes()
