"""The differences between the environment of a training and another one."""

import logging
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from qtab.envs.class_code import LIBRARY
from qtab.envs.origin.description import EnvironmentDescription, WrapperDescription
from qtab.envs.origin.values import comparable, in_words, same, without_digest
from qtab.envs.registry import gymnasium_id

_LOGGER = logging.getLogger("qtab")
_logged: set[str] = set()
"""The messages that were logged in this process."""
_NOT_SET = "as the constructor leaves it"


def differences(trained_on: EnvironmentDescription, given: EnvironmentDescription) -> list[str]:
    """Returns the differences, in sentences; none if the two are equal as far as is known.

    The id of this package and that of Gymnasium count as equal, since they have the same numbers. The time limit is a
    setting of the run, and is compared there. Edited code of the user may still give the same numbers, so that it
    is only logged, once per process.

    Args:
        trained_on: The environment of the training.
        given: The other environment.
    """
    for name in _edited(trained_on, given):
        _log_once(f"the code of {name} was edited since the training of {trained_on.name}: its numbers may differ")
    return list(_all(trained_on, given))


def _edited(ours: EnvironmentDescription, theirs: EnvironmentDescription) -> Iterator[str]:
    pairs: list[tuple[Any, Any]] = [(ours, theirs), *zip(ours.wrappers, theirs.wrappers, strict=False)]
    for one, other in pairs:
        if _class_name(one) == _class_name(other) and one.code != other.code and comparable(one.code, other.code):
            yield _class_name(one)


def _log_once(message: str) -> None:
    if message not in _logged:
        _logged.add(message)
        _LOGGER.warning("%s", message)


def _all(ours: EnvironmentDescription, theirs: EnvironmentDescription) -> Iterator[str]:
    if _bare(ours.name) != _bare(theirs.name):
        yield f"the run was trained on {ours.name}, not on {theirs.name}"
        return
    if not (ours.code == theirs.code == LIBRARY):
        if _class_name(ours) != _class_name(theirs):
            yield f"the run was trained on the class {ours.cls}, not on {theirs.cls}"
        elif LIBRARY in (ours.code, theirs.code):
            yield f"methods of its class {_class_name(ours)} were replaced {_when(ours)}"
    yield from _values("its argument", ours.kwargs, theirs.kwargs, "not given")
    yield from _values("its attribute", ours.attributes, theirs.attributes, _NOT_SET)
    if ours.table != theirs.table:
        yield "its transition table is not that of the training"
    yield from _wrappers(ours.wrappers, theirs.wrappers)
    for name in ("observation_space", "action_space"):
        one, other = getattr(ours, name), getattr(theirs, name)
        if one != other:
            yield f"its {name} was {without_digest(one)} in training, and is {without_digest(other)}"


def _wrappers(ours: tuple[WrapperDescription, ...], theirs: tuple[WrapperDescription, ...]) -> Iterator[str]:
    if [wrapper.name for wrapper in ours] != [wrapper.name for wrapper in theirs]:
        yield f"the run was trained {_listed(ours)}, and this environment is {_listed(theirs)}"
        return
    for one, other in zip(ours, theirs, strict=True):
        if one.code != other.code and LIBRARY in (one.code, other.code):
            yield f"methods of the wrapper {one.name} were replaced {_when(one)}"
        what = f"of the wrapper {one.name}, the"
        if one.kwargs is not None and other.kwargs is not None:
            yield from _values(f"{what} argument", one.kwargs, other.kwargs, "not given")
        yield from _values(f"{what} attribute", one.attributes, other.attributes, _NOT_SET)


def _listed(wrappers: tuple[WrapperDescription, ...]) -> str:
    return f"in the wrapper {', '.join(wrapper.name for wrapper in wrappers)}" if wrappers else "without a wrapper"


def _values(what: str, ours: Mapping[str, Any], theirs: Mapping[str, Any], missing: str) -> Iterator[str]:
    show: Callable[[Mapping[str, Any], str], str] = lambda held, name: in_words(held[name]) if name in held else missing  # noqa: E731
    for name in sorted(ours.keys() | theirs.keys()):
        if name in ours and name in theirs and same(ours[name], theirs[name]):
            continue
        yield f"{what} {name} was {show(ours, name)} in training, and is {show(theirs, name)}"


def _when(ours: EnvironmentDescription | WrapperDescription) -> str:
    return "after the training" if ours.code == LIBRARY else "in training, and are not replaced now"


def _class_name(description: EnvironmentDescription | WrapperDescription) -> str:
    return description.cls.rpartition(":")[2].rpartition(".")[2]


def _bare(name: str) -> str:
    return gymnasium_id(name.rpartition(":")[2])
