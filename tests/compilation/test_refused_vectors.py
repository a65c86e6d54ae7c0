"""Ordinary classes that vector environments refuse to compile, since they would differ from SyncVectorEnv."""

from typing import Any

import gymnasium as gym
import pytest

import qtab
from qtab.compilation.rewriting import rewrite
from support.environments.gym_classes import refused_vectors, unsafe_values
from support.lockstep.own_vectors import in_lockstep, make

pytest.importorskip("numba")
pytestmark = pytest.mark.usefixtures("unregistered")


@pytest.mark.parametrize(
    ("made", "mode", "reason"),
    [
        (refused_vectors.SharesMemory, "NextStep", "self.position is changed in place, and "),
        (refused_vectors.ClassArray, "NextStep", "a ndarray outside of the environment is changed"),
        (refused_vectors.Random, "NextStep", "two environments that are made differ in self.noise"),
        (refused_vectors.ShowsView, "SameStep", "the observation shares memory with self.position"),
        (refused_vectors.ShowsViewAtTheEnd, "SameStep", "the observation shares memory with self.position"),
        (refused_vectors.ShowsParameter, "SameStep", "the observation shares memory with self.position"),
        (refused_vectors.OtherDtype, "NextStep", "reset returns an array of int64 for a space of uint8"),
        (refused_vectors.Doubles, "SameStep", "reset returns an array of int64 for a space of float32"),
        (refused_vectors.Informs, "NextStep", "the info dict has 'speed', which compiled code leaves out"),
        (refused_vectors.ChangesInfo, "NextStep", "the info dict info is changed or used here"),
        (refused_vectors.PassesInfoOn, "NextStep", "the info dict info is changed or used here"),
        (refused_vectors.OneMask, "NextStep", "this info dict has another action mask than others"),
        (refused_vectors.OtherMask, "NextStep", "is not what action_masks() returns"),
        (refused_vectors.MaskOfBase, "NextStep", "super().action_masks"),
        (refused_vectors.NoOptions, "NextStep", "reset does not take seed and options"),
        (refused_vectors.DefaultOptions, "NextStep", "options of reset have no default None"),
        (refused_vectors.Prints, "NextStep", "print"),
        (refused_vectors.Resets, "NextStep", "or draws from self.np_random; do not reset in `__init__`"),
        (refused_vectors.Keeps, "NextStep", "self.steps keeps its value from one episode to the next"),
        (refused_vectors.Warns, "NextStep", "a message is logged, which compiled code leaves out"),
    ],
)
def test_classes_that_would_differ_are_refused_by_name(made: Any, mode: str, reason: str) -> None:
    gym.register(f"QtabVec/{made.__name__}-v0", made)
    with pytest.raises(ValueError, match=f"Rust steps, got 'QtabVec/{made.__name__}-v0': Rust does not") as raised:
        qtab.RustVectorEnv(f"QtabVec/{made.__name__}-v0", 2, autoreset_mode=mode)
    assert reason in str(raised.value)
    assert str(raised.value).endswith("or step it with gymnasium.vector.SyncVectorEnv")


@pytest.mark.parametrize(
    "made",
    [
        *(refused_vectors.Divides, refused_vectors.AddsUp, unsafe_values.BecomesNone),
        *(unsafe_values.BecomesNoneBesides, unsafe_values.ExtendsByNumber, unsafe_values.AppendsTwo),
        unsafe_values.ReadsProperty,
        *(unsafe_values.TruthOfArray, unsafe_values.ChoiceByArray, unsafe_values.AddsToText),
        *(unsafe_values.SmallIntegers, unsafe_values.BooleansOfNumPy),
        *(unsafe_values.SmallIntegersOrOthers, unsafe_values.SmallIntegersAtTimes),
    ],
)
def test_values_that_nothing_reads_must_be_safe(made: Any) -> None:
    refusal = rewrite(made()).shown.refusal
    assert refusal is not None
    assert "an error might be raised here, in a value that compiled code leaves out" in str(refusal)
    assert rewrite(unsafe_values.Counted()).shown.refusal is None


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_views_and_other_dtypes_are_shown_where_no_last_observation_is() -> None:
    made: Any
    for made in (refused_vectors.ShowsView, refused_vectors.Doubles):
        gym.register(f"QtabVec/{made.__name__}Next-v0", made)
        ours, theirs = make(f"QtabVec/{made.__name__}Next-v0", 3, max_episode_steps=5)
        assert ours.is_native
        in_lockstep(ours, theirs, 12, 0)


def test_copies_may_differ_in_what_no_step_reads() -> None:
    gym.register("QtabVec/Numbered-v0", refused_vectors.Numbered)  # type: ignore[arg-type]
    ours, theirs = make("QtabVec/Numbered-v0", 2, max_episode_steps=5)
    assert ours.is_native
    in_lockstep(ours, theirs, 8, 0)
    numbers = ours.get_attr("number")
    assert numbers[0] != numbers[1]
    assert ours.get_attr("total") == theirs.get_attr("total")
