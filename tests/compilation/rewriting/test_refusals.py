"""What cannot be rewritten is refused by name: the file, the line, the code, and what to write instead."""

import copy
import enum
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting import rewrite
from support.environments.gym_classes import control, games, grids, refused, shared, walk
from support.environments.marked import marked_line
from support.lockstep.rewriting import assert_equal_steps

REFUSALS = {
    refused.NumpyExp: ("np.exp rounds differently", "write math.exp for np.exp"),
    refused.Power: ("a float to a power", "write x * x"),
    refused.Formatted: ("an f-string", "use numbers"),
    refused.DictState: ("self.visits is a dict that changes", "use a NumPy array indexed by integers"),
    refused.ListState: ("the method append", "use numbers and NumPy arrays"),
    refused.TryExcept: ("try/except", "test the condition with if"),
    refused.GlobalRandom: ("random numbers of the module random", "draw from self.np_random"),
    refused.NumpyRandom: ("random numbers outside self.np_random", "draw from self.np_random"),
    refused.OwnGenerator: ("a second random generator", "draw from self.np_random"),
    refused.Clock: ("the clock is read", "count steps"),
    refused.File: ("a file is opened", "read files in __init__"),
    refused.Prints: ("print is called", "log in a wrapper"),
    refused.GlobalState: ("something other than an array of self", "an attribute of the environment"),
    refused.GlobalStatement: ("an assignment to a global variable", "an attribute of the environment"),
    refused.MutableDefault: ("a list is changed", "a NumPy array of fixed size"),
    refused.CreatedLate: ("self.bonus does not exist after reset", "in __init__"),
    refused.OptionalState: ("self.last is None after reset", "such as -1"),
    refused.ChangingType: ("self.flag is a boolean after reset, and an integer here", "converted explicitly"),
    refused.StringState: ("self.mood is a string that changes", "use an integer"),
    refused.SharedArray: ("self.cells shares memory", "write .copy()"),
    refused.SharedLocal: ("cells may share its memory", "write .copy()"),
    refused.SeedUsed: ("the seed is used", "super().reset(seed=seed)"),
    refused.DrawsFirst: ("reset draws before super().reset", "first"),
    refused.NeverSeeds: ("does not seed the generator", "call super().reset(seed=seed) first"),
    refused.ImpureInfo: ("this is left out in compiled code", "without drawing"),
    refused.ReadsInfo: ("the method get of an info dict", "use numbers"),
    refused.SamplesSpace: ("a space has a random generator", "draw from self.np_random"),
    refused.Shuffles: ("Generator.shuffle", "permutation"),
    refused.FloatSum: ("the sum of an array of float64", "in a loop"),
    refused.SinglePrecision: ("a NumPy float32 in arithmetic", "float(...)"),
    refused.SignedZero: ("the sign of a zero would differ", "such as 0.0 for 0"),
    refused.RecursiveHelper: ("depth calls itself", "write a loop"),
    refused.Generates: ("cells_of is a generator", "write a loop"),
    refused.BigDict: ("a string is used as a value", "use an integer"),
    refused.Hypotenuse: ("math.hypot may round differently", "math.sqrt(x * x + y * y)"),
    refused.SometimesUnset: ("the variable bonus may not be set", "before the branch"),
    refused.ChangesDict: ("something other than an array of self", "an attribute of the environment"),
    refused.ArrayCondition: ("the truth value of an array", "write .any() or .all()"),
    refused.ListObservation: ("the observation is a tuple of 1", "return np.array"),
}


@pytest.mark.parametrize("cls", REFUSALS, ids=lambda cls: cls.__name__)
def test_the_refusal_names_the_line_and_what_to_write_instead(cls: Any) -> None:
    with pytest.raises(NotCompilable) as caught:
        rewrite(cls())
    reason, advice = REFUSALS[cls]
    assert Path(str(caught.value.file)).name == "refused.py"
    assert caught.value.line == marked_line(cls)
    assert reason in caught.value.reason
    assert advice in caught.value.advice
    assert str(caught.value).startswith(f"{caught.value.file}:{marked_line(cls)}: ")


SHARED = [
    shared.FollowsAttribute,
    shared.FollowsPart,
    shared.FollowsInAnotherAttribute,
    shared.FollowsThroughHelper,
    shared.FollowsInParameter,
    shared.FollowsList,
    shared.FollowsInLoop,
]


@pytest.mark.parametrize("cls", SHARED, ids=lambda cls: cls.__name__)
def test_names_of_memory_that_is_changed_in_place_are_refused(cls: Any) -> None:
    with pytest.raises(NotCompilable, match=r"shares? .*memory.*changed in place.*\.copy\(\)") as caught:
        rewrite(cls())
    assert caught.value.line == marked_line(cls)


def test_attributes_that_share_memory_from_the_beginning_are_refused() -> None:
    with pytest.raises(NotCompilable, match=r"self\.counts is changed in place, and shares memory with self\.shown"):
        rewrite(shared.SharesInInit())


@pytest.mark.parametrize("cls", [shared.ReadsOnly, shared.CopiesFirst], ids=lambda cls: cls.__name__)
def test_other_names_of_memory_are_compiled(cls: Any) -> None:
    env = cls()
    assert_equal_steps(env, rewrite(env), 500)


def test_the_code_is_shown() -> None:
    with pytest.raises(NotCompilable, match=r"in `np\.exp\(-self\.x \* self\.x\)`"):
        rewrite(refused.NumpyExp())


@pytest.mark.parametrize(
    ("id_", "reason"),
    [
        ("CartPole-v1", "self.steps_beyond_terminated is None after reset"),
        ("MountainCar-v0", "self.state is an array of float64"),
        ("Acrobot-v1", "float32"),
        ("FrozenLake-v1", "np.cumsum"),
        ("CliffWalking-v1", "np.cumsum"),
        ("Blackjack-v1", "`in` with a tuple of 2"),
    ],
)
def test_the_classes_of_gymnasium_are_refused_for_what_they_do(id_: str, reason: str) -> None:
    with pytest.raises(NotCompilable) as caught:
        rewrite(gym.make(id_).unwrapped)
    assert reason in caught.value.reason


def test_only_discrete_actions_are_compiled() -> None:
    with pytest.raises(NotCompilable, match="the action space is a Box"):
        rewrite(gym.make("Pendulum-v1").unwrapped)


def test_a_wrapper_is_refused() -> None:
    with pytest.raises(NotCompilable, match="TimeLimit is a wrapper"):
        rewrite(gym.wrappers.TimeLimit(control.ThermostatEnv(), 10))


def test_a_replaced_method_is_refused() -> None:
    env: Any = control.ThermostatEnv()
    env._observation = lambda: np.zeros(1, dtype=np.float32)
    with pytest.raises(NotCompilable, match="_observation was replaced on the object"):
        rewrite(env)


def test_a_class_without_source_is_refused() -> None:
    scope: dict[str, Any] = {"Base": walk.Base}
    exec("class Typed(Base):\n    def change(self, action):\n        return 1.0\n", scope)  # noqa: S102
    with pytest.raises(NotCompilable, match=r"the source code of .*change is not available.*define the class"):
        rewrite(scope["Typed"]())


def test_the_environment_is_not_changed() -> None:
    env = control.ThermostatEnv()
    env.reset(seed=4)
    before = copy.deepcopy(vars(env))
    rewrite(env)
    assert before.keys() == vars(env).keys()
    assert before["temperature"] == env.temperature
    assert str(before["_np_random"].bit_generator.state) == str(env.np_random.bit_generator.state)


def test_lines_lead_to_the_users_file() -> None:
    rewritten = rewrite(control.ThermostatEnv())
    number = next(i for i, line in enumerate(rewritten.source.splitlines(), 1) if "rng.normal" in line)
    file, line = rewritten.lines[number]
    assert "self.np_random.normal" in Path(file).read_text(encoding="utf-8").splitlines()[line - 1]


def test_masks_that_depend_on_local_variables_are_refused_by_name() -> None:
    class Masked(walk.Base):
        def step(self, action):
            mask = np.ones(3, dtype=np.int8)
            return self.observe(), 0.0, True, False, {"action_mask": mask}

    rewritten = rewrite(Masked())
    assert rewritten.action_mask is None
    assert "write a method action_masks(self)" in str(rewritten.mask_refusal)


@pytest.mark.parametrize("env", [grids.MaskedGridEnv(), games.TicTacToeEnv()], ids=lambda env: type(env).__name__)
def test_masks_of_the_info_dict_and_of_the_method_are_found(env: gym.Env) -> None:
    rewritten = rewrite(env)
    assert rewritten.action_mask is not None
    assert rewritten.mask_refusal is None


def test_attributes_that_are_never_read_are_left_out() -> None:
    rewritten = rewrite(control.PendulumEnv())
    assert set(rewritten.dtype.names or ()) == {"state.0", "state.1"}


def test_an_attribute_keeps_its_value_until_it_is_assigned() -> None:
    env = games.GamblerEnv()
    env.episodes = 41
    rewritten = rewrite(env)
    assert rewritten.initial["episodes"][0] == 41
    assert_equal_steps(env, rewritten, 200)


@pytest.mark.parametrize(
    ("env", "kept"),
    [
        (control.ThermostatEnv(), ()),
        (control.LanderEnv(), ("state",)),
        (games.GamblerEnv(), ("episodes", "flips")),
        (grids.MazeEnv(), ()),
        (grids.GridWorldEnv(), ()),
    ],
    ids=lambda value: type(value).__name__,
)
def test_attributes_that_outlive_an_episode_are_named(env: gym.Env, kept: tuple[str, ...]) -> None:
    assert rewrite(env).kept_between_episodes == kept


class Heading(enum.Enum):
    NORTH = 0
    EAST = 1


def test_a_member_of_an_enum_that_changes_is_named_with_its_value() -> None:
    class Turns(walk.Base):
        def reset(self, *, seed=None, options=None):
            self.heading = Heading.EAST
            self.path = []
            return super().reset(seed=seed)

        def change(self, action):
            self.path.append(action)
            return 1.0 if self.heading == Heading.EAST else 0.0

    with pytest.raises(NotCompilable, match=r"self\.heading is a member of Heading that changes") as caught:
        rewrite(Turns())
    assert caught.value.advice == "keep its number, as in self.heading = Heading.EAST.value"
    assert all("path" not in problem for problem in caught.value.problems)
