"""Steps of qtab's classic control equal Gymnasium's."""

import gymnasium as gym
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from qtab import _core
from qtab.envs.classic_control import AcrobotEnv
from support.lockstep.classic_control import CONTINUOUS, EDITS, IDS, LockstepClassicControl, heuristic_policy
from support.processes.machine import MACHINE

STEPS = 4_000
"""Random steps; as many are taken by a policy that reaches the goal."""


@pytest.mark.slow
@pytest.mark.parametrize("name", IDS[1:])  # test_mountain_car_steps.py walks as far with MountainCar-v0
@pytest.mark.parametrize("policy", [None, heuristic_policy], ids=["random", "heuristic"])
def test_long_walks_equal_gymnasiums(name, policy, record_property):
    record_property("machine", MACHINE)
    pair = LockstepClassicControl(name)
    pair.reset(seed=7)
    episodes = pair.run(STEPS, policy, seed=11)
    if policy is heuristic_policy and name not in ("CartPole-v1", "Pendulum-v1"):
        assert episodes > 12  # the goal was met, not only the slope below


def test_rust_steps_where_numpy_uses_libm(monkeypatch):
    stepped = []
    monkeypatch.setattr(
        "qtab.envs.classic_control.ClassicControlMixin.step_in_python", lambda env, action: stepped.append(env)
    )
    for name in IDS:
        env = gym.make(f"qtab/{name}").unwrapped
        env.reset(seed=0)
        env.step(env.action_space.sample())
        uses_numpy = "MountainCar" not in name
        assert bool(stepped) == (uses_numpy and not _core.numpy_uses_libm()), name
        stepped.clear()


@pytest.mark.filterwarnings("ignore:.*out of date")
@pytest.mark.parametrize(
    ("name", "kwargs"),
    [
        ("MountainCar-v0", {"goal_velocity": 0.03}),
        ("MountainCarContinuous-v0", {"goal_velocity": 0.02}),
        ("MountainCarContinuous-v0", {"goal_velocity": np.float32(0.02)}),
        ("CartPole-v1", {"sutton_barto_reward": True}),
        ("CartPole-v0", {"sutton_barto_reward": True}),
        ("Pendulum-v1", {"g": 9.81}),
        ("Pendulum-v1", {"g": 2}),
        ("Pendulum-v1", {"g": np.float64(3.7)}),
    ],
)
def test_every_constructor_argument_has_its_effect(name, kwargs):
    pair = LockstepClassicControl(name, **kwargs)
    pair.reset(seed=1)
    pair.run(500)
    pair.run(500, heuristic_policy)


ATTRIBUTES = [(name, attribute, value) for name, edits in EDITS.items() for attribute, value in edits.items()]


@pytest.mark.parametrize(("name", "attribute", "value"), ATTRIBUTES)
def test_every_assigned_attribute_is_used_from_the_next_step(name, attribute, value):
    pair = LockstepClassicControl(name)
    pair.reset(seed=2)
    pair.run(30, heuristic_policy)
    pair.set(**{attribute: value})
    assert getattr(pair.ours, attribute) == value
    pair.run(100, None)
    pair.run(120, heuristic_policy)
    if isinstance(value, float):
        for width in (np.float32, np.float64):  # NumPy scalars promote differently
            pair.set(**{attribute: width(value)})
            pair.run(50)


def test_an_assigned_action_space_and_torques_are_used():
    pair = LockstepClassicControl("CartPole-v1")
    pair.reset(seed=1)
    pair.set(action_space=gym.spaces.Discrete(2, start=1))
    for action in (1, 2, 0):
        pair.both(lambda env, action=action: env.step(action))
    pair = LockstepClassicControl("Acrobot-v1")
    pair.set(AVAIL_TORQUE=[-1.0, 0.0, 1])
    pair.reset(seed=1)
    for torque in (3, -2.5, np.float64(0.5), np.float32(0.1), True, None, "much"):
        pair.both(lambda env, torque=torque: env.AVAIL_TORQUE.__setitem__(1, torque))
        pair.both(lambda env: env.step(1))
        pair.both(lambda env: env.step(-1))


def test_torque_noise_is_drawn_from_numpy():
    pair = LockstepClassicControl("Acrobot-v1")
    pair.set(torque_noise_max=1.0)
    pair.reset(seed=5)
    pair.run(500)
    pair.both(lambda env: env.np_random.random())


def test_a_subclass_may_override_constants():
    class Light(AcrobotEnv):
        dt = 0.1

    class Theirs(gym.envs.classic_control.AcrobotEnv):
        dt = 0.1

    pair = LockstepClassicControl("Acrobot-v1")
    pair.ours, pair.theirs = Light(), Theirs()
    pair.reset(seed=0)
    pair.run(300)
    Light.dt = Theirs.dt = 0.3
    pair.reset()
    pair.run(300)


@pytest.mark.parametrize("name", IDS)
@pytest.mark.parametrize("form", [np.float64, np.float32, tuple, list, None])
def test_an_assigned_state_of_any_type_is_used(name, form):
    pair = LockstepClassicControl(name)
    pair.reset(seed=3)
    pair.run(20)
    numbers = [-0.4, 0.01] if "Mountain" in name else [0.05, 0.2] if "Pend" in name else [0.05, 0.2, -0.1, 0.3]
    state = numbers if form is list else tuple(numbers) if form is tuple else form and np.array(numbers, form)
    pair.set(state=state)
    if form is None and name != "CartPole-v1" and name != "Acrobot-v1":
        with pytest.raises(gym.error.ResetNeeded):
            pair.ours.step(pair.ours.action_space.sample())
        return
    action = pair.theirs.action_space.sample()
    for _ in range(3):
        pair.both(lambda env: env.step(action))


@pytest.mark.parametrize("name", IDS)
def test_a_state_edited_in_place_is_used(name):
    pair = LockstepClassicControl(name)
    pair.reset(seed=3)
    action = pair.theirs.action_space.sample()
    for _ in range(3):
        pair.both(lambda env: env.state.__setitem__(1, 0.02) if isinstance(env.state, np.ndarray) else None)
        pair.both(lambda env: env.step(action))
    assert pair.ours.state is pair.ours.state


@pytest.mark.parametrize("name", IDS)
@pytest.mark.parametrize(
    "options",
    [{"low": -0.3, "high": -0.2}, {"low": 1}, {"x_init": 0.1, "y_init": 3}, {"high": "up"}, {"x_init": None}, {}],
)
def test_reset_options_equal_gymnasiums(name, options):
    pair = LockstepClassicControl(name)
    pair.reset(seed=4, options=options)
    if hasattr(pair.theirs, "state") and pair.theirs.state is not None:
        pair.run(50)


WIDTHS = st.sampled_from([np.float32, np.float64])
FORCES = st.floats(-3, 3) | st.floats(width=32) | st.sampled_from([0.0, -0.0, 1.0, -2.0, 2.0, np.nan, np.inf, 1e300])


@pytest.mark.parametrize("name", CONTINUOUS)
@given(forces=st.lists(st.tuples(FORCES, WIDTHS), max_size=8), seed=st.integers(0, 99))
def test_forces_of_any_size_and_dtype_equal_gymnasiums(name, forces, seed):
    pair = LockstepClassicControl(name)
    pair.reset(seed=seed)
    for force, width in forces:
        with np.errstate(over="ignore"):
            action = np.array([force]).astype(width)
        pair.both(lambda env, action=action: env.step(action))
        pair.both(lambda env: getattr(env, "last_u", None))


ODD = [[0.5], (1,), np.array([1]), np.array([True]), 0.5, np.float32(0.5), np.array(0.5), np.array([0.3, 0.9]), None]
ODD += [np.array([[0.5]]), np.array([]), np.array([0.5], np.float16), np.array([0.9, 0, 0.1])[::-2], "a", 1, 0, -1, 3]
ODD += [np.int64(1), np.uint8(0), np.int8(-1), True, 1.0, 2**70, np.array([1, 0]), slice(2)]


@pytest.mark.parametrize("name", IDS)
@pytest.mark.parametrize("action", ODD, ids=repr)
def test_odd_actions_have_gymnasiums_result(name, action):
    if name == "MountainCar-v0" and type(action) is np.uint8:
        return  # here Gymnasium's own arithmetic wraps around
    pair = LockstepClassicControl(name)
    pair.reset(seed=6)
    pair.both(lambda env: env.step(action))


@pytest.mark.parametrize("name", ["CartPole-v1", "Acrobot-v1"])
def test_a_step_before_a_reset_raises_gymnasiums_error(name):
    LockstepClassicControl(name).both(lambda env: env.step(0))


@pytest.mark.parametrize("name", ["MountainCar-v0", *CONTINUOUS])
def test_a_step_before_a_reset_is_refused_where_gymnasium_fails_with_another_error(name):
    env = gym.make(f"qtab/{name}").unwrapped
    assert not hasattr(env, "state")
    with pytest.raises(gym.error.ResetNeeded):
        env.step(env.action_space.sample())


def test_stepping_after_termination_warns_once():
    pair = LockstepClassicControl("CartPole-v1")
    pair.reset(seed=0)
    warned = [bool(pair.both(lambda env: env.step(1))[1]) for _ in range(40)]
    assert sum(warned) == 1
    pair.both(lambda env: env.steps_beyond_terminated)
    pair.reset()
    pair.run(50)


@pytest.mark.parametrize("name", IDS)
def test_overflow_raises_what_python_raises(name):
    for huge in (1e155, 1e308, np.inf, np.nan):
        pair = LockstepClassicControl(name)
        pair.reset(seed=0)
        if name != "Acrobot-v1":  # Gymnasium would subtract turns forever
            pair.set(state=np.full(len(pair.theirs.state), huge))
            action = pair.theirs.action_space.sample()
            pair.both(lambda env, action=action: env.step(action))
    for zero in ({"l": 0.0}, {"length": 0.0}, {"total_mass": 0.0}, {"LINK_MOI": 0.0, "LINK_MASS_2": 0.0}, {"l": 1e200}):
        pair = LockstepClassicControl(name)
        pair.reset(seed=0)
        pair.set(**zero)
        pair.both(lambda env: env.step(heuristic_policy(env)))
