"""Classic control in lock-step with Gymnasium's."""

from collections.abc import Callable
from typing import Any

import numpy as np

from support.exact import identical
from support.lockstep import Lockstep
from support.processes.machine import MACHINE

IDS = ["MountainCar-v0", "MountainCarContinuous-v0", "CartPole-v1", "Acrobot-v1", "Pendulum-v1"]
CONTINUOUS = ["MountainCarContinuous-v0", "Pendulum-v1"]


class LockstepClassicControl(Lockstep):
    """An environment of classic control beside Gymnasium's."""

    def run(self, steps: int, policy: Callable[[Any], Any] | None = None, seed: int = 0) -> int:
        """Takes so many steps, at random or by a policy, and returns how many episodes terminated."""
        episodes = 0
        actions = [] if policy else self.random_actions(steps, seed)
        for step in range(steps):
            action = policy(self.theirs) if policy else actions[step]
            ours, theirs = self.ours.step(action), self.theirs.step(action)
            assert identical(ours, theirs), (self.name, step, ours, theirs, MACHINE)
            if step % 97 == 0:
                self.assert_same_state()
            if theirs[2] or step % 200 == 199:
                episodes += theirs[2]
                self.reset()
        self.assert_same_state()
        return episodes

    def random_actions(self, count: int, seed: int) -> list[Any]:
        rng, space = np.random.default_rng(seed), self.theirs.action_space
        if self.name in CONTINUOUS:
            return list(rng.uniform(space.low, space.high, (count, 1)).astype(space.dtype))
        return list(rng.integers(space.start, space.start + space.n, count))

    def assert_same_state(self) -> None:
        ours, theirs = self.ours.state, self.theirs.state
        assert type(ours) is type(theirs)
        # At the left wall Gymnasium's MountainCar has a velocity of integer 0.
        assert isinstance(ours, tuple) or ours.dtype == theirs.dtype
        assert np.array(ours, np.float64).tobytes() == np.array(theirs, np.float64).tobytes()


def heuristic_policy(env: Any) -> Any:
    """A simple policy that reaches the goal, or balances."""
    if "MountainCar" in type(env).__name__ and "Continuous" not in type(env).__name__:
        return 2 if env.state[1] >= 0 else 0
    if "CartPole" in type(env).__name__:
        return int(env.state[2] + 0.5 * env.state[3] + 0.05 * env.state[1] > 0)
    if "Acrobot" in type(env).__name__:
        return 0 if env.state[2] > 0 else 2
    if "Pendulum" in type(env).__name__:
        theta, speed = (env.state[0] + np.pi) % (2 * np.pi) - np.pi, env.state[1]
        return np.array([-10 * theta - 2 * speed if abs(theta) < 0.6 else 2 * np.sign(speed)], np.float32)
    return np.array([1.5 if env.state[1] >= 0 else -0.75], np.float32)


LINKS = dict.fromkeys(["LINK_LENGTH_1", "LINK_MASS_1", "LINK_MASS_2", "LINK_COM_POS_1", "LINK_COM_POS_2"], 0.7)
EDITS: dict[str, dict[str, Any]] = {
    "MountainCar-v0": {"force": 0.002, "gravity": 0.002, "max_speed": 0.05, "goal_position": 0.3, "goal_velocity": 0.01}
    | {"min_position": -0.9, "max_position": 0.45},
    "MountainCarContinuous-v0": {"power": 0.002, "max_speed": 0.05, "goal_position": 0.3, "goal_velocity": 0.01}
    | {"min_position": -0.9, "max_position": 0.35, "min_action": -0.4, "max_action": 0.3},
    "CartPole-v1": {"gravity": 1.6, "masspole": 0.3, "total_mass": 2.0, "length": 0.8, "polemass_length": 0.1}
    | {"force_mag": 4, "tau": 0.05, "theta_threshold_radians": 0.1, "x_threshold": 1.5, "_sutton_barto_reward": True}
    | {"kinematics_integrator": "semi-implicit", "steps_beyond_terminated": 3, "masscart": 5.0},
    "Acrobot-v1": LINKS
    | {"dt": 0.05, "LINK_MOI": 2.0, "MAX_VEL_1": 2, "MAX_VEL_2": 3.0, "torque_noise_max": 0.5, "LINK_LENGTH_2": 2.0}
    | {"book_or_nips": "nips", "AVAIL_TORQUE": [-2, 0.5, 2.0]},
    "Pendulum-v1": {"max_speed": 3, "max_torque": 0.5, "dt": 0.1, "g": 5.0, "m": 2.0, "l": 0.7},
}
"""For each environment, attributes that its step reads, with values other than the defaults."""
