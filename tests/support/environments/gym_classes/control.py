"""Control problems: thermostats, pendulums, carts."""

import math
from dataclasses import dataclass
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium import spaces
from gymnasium.envs.classic_control import mountain_car

GRAVITY = 9.81


class ThermostatEnv(gym.Env):
    """Keeps a room warm, with noise."""

    observation_space = spaces.Box(0.0, 40.0, (1,))
    action_space = spaces.Discrete(2)

    def __init__(self, gain: float = 1.5) -> None:
        self.gain = gain

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.temperature = self.np_random.uniform(10.0, 30.0)
        self.steps = 0
        return self._observation(), {}

    def step(self, action):
        self.temperature += self.gain * action - 0.1 * (self.temperature - 12.0) + self.np_random.normal(0.0, 0.1)
        self.steps += 1
        return self._observation(), -abs(self.temperature - 20.0), False, self.steps >= 100, {}

    def _observation(self):
        return np.array([min(max(self.temperature, 0.0), 40.0)], dtype=np.float32)


@dataclass(frozen=True)
class PendulumSettings:
    mass: float = 1.0
    length: float = 1.0
    dt: float = 0.05
    max_speed: float = 8.0


def normalized(angle):
    return ((angle + math.pi) % (2 * math.pi)) - math.pi


class PendulumEnv(gym.Env):
    """A pendulum with three torques; settings in a dataclass, a function of the module, the state in a tuple."""

    TORQUES = [-2.0, 0.0, 2.0]  # noqa: RUF012

    def __init__(self, settings: PendulumSettings | None = None, render_mode: str | None = None) -> None:
        self.settings = settings or PendulumSettings()
        self.render_mode = render_mode
        high = np.array([1.0, 1.0, self.settings.max_speed], dtype=np.float32)
        self.observation_space = spaces.Box(-high, high, dtype=np.float32)
        self.action_space = spaces.Discrete(3)
        self.last_torque = None

    def step(self, action):
        theta, speed = self.state  # type: ignore[has-type]
        torque = self.TORQUES[action]
        self.last_torque = torque
        s = self.settings
        cost = normalized(theta) * normalized(theta) + 0.1 * speed * speed + 0.001 * (torque * torque)
        acceleration = 3 * GRAVITY / (2 * s.length) * np.sin(theta) + 3.0 / (s.mass * s.length**2) * torque
        speed = np.clip(speed + acceleration * s.dt, -s.max_speed, s.max_speed)
        self.state = (theta + speed * s.dt, speed)
        if self.render_mode == "human":
            self.render()
        return self._get_obs(), -cost, False, False, {"torque": torque}

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.state = (self.np_random.uniform(-math.pi, math.pi), self.np_random.uniform(-1, 1))
        self.last_torque = None
        return self._get_obs(), {}

    def _get_obs(self):
        theta, speed = self.state
        return np.array([math.cos(theta), math.sin(theta), speed], dtype=np.float32)


class CartEnv(gym.Env):
    """CartPole as it is copied into projects: the state in an array, NaN for 'not yet', an integrator by name."""

    def __init__(self, kinematics_integrator: str = "euler") -> None:
        self.gravity, self.masscart, self.masspole, self.length = 9.8, 1.0, 0.1, 0.5
        self.total_mass = self.masspole + self.masscart
        self.polemass_length = self.masspole * self.length
        self.force_mag = 10.0
        self.tau = 0.02
        self.kinematics_integrator = kinematics_integrator
        self.theta_threshold_radians = 12 * 2 * math.pi / 360
        self.x_threshold = 2.4
        high = np.array(
            [self.x_threshold * 2, np.inf, self.theta_threshold_radians * 2, np.inf],
            dtype=np.float32,
        )
        self.action_space = spaces.Discrete(2)
        self.observation_space = spaces.Box(-high, high, dtype=np.float32)
        self.state: Any = None
        self.beyond = -1

    def step(self, action):
        assert self.action_space.contains(action), f"{action!r} ({type(action)}) invalid"
        assert self.state is not None, "Call reset before using step method."
        x, x_dot, theta, theta_dot = self.state
        force = self.force_mag if action == 1 else -self.force_mag
        costheta = np.cos(theta)
        sintheta = np.sin(theta)
        temp = (force + self.polemass_length * (theta_dot * theta_dot) * sintheta) / self.total_mass
        thetaacc = (self.gravity * sintheta - costheta * temp) / (
            self.length * (4.0 / 3.0 - self.masspole * (costheta * costheta) / self.total_mass)
        )
        xacc = temp - self.polemass_length * thetaacc * costheta / self.total_mass
        if self.kinematics_integrator == "euler":
            x = x + self.tau * x_dot
            x_dot = x_dot + self.tau * xacc
            theta = theta + self.tau * theta_dot
            theta_dot = theta_dot + self.tau * thetaacc
        else:
            x_dot = x_dot + self.tau * xacc
            x = x + self.tau * x_dot
            theta_dot = theta_dot + self.tau * thetaacc
            theta = theta + self.tau * theta_dot
        self.state = np.array((x, x_dot, theta, theta_dot), dtype=np.float64)
        terminated = bool(
            x < -self.x_threshold
            or x > self.x_threshold
            or theta < -self.theta_threshold_radians
            or theta > self.theta_threshold_radians
        )
        if not terminated:
            reward = 1.0
        elif self.beyond == -1:
            self.beyond = 0
            reward = 1.0
        else:
            if self.beyond == 0:
                gym.logger.warn("step() after the end of the episode")
            self.beyond += 1
            reward = 0.0
        return np.array(self.state, dtype=np.float32), reward, terminated, False, {}

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.state = self.np_random.uniform(low=-0.05, high=0.05, size=(4,))
        self.beyond = -1
        return np.array(self.state, dtype=np.float32), {}


class TupleMountainCarEnv(mountain_car.MountainCarEnv):
    """Gymnasium's MountainCar, with a reset that stores a tuple as ``step`` does."""

    def reset(self, *, seed=None, options=None):
        gym.Env.reset(self, seed=seed)
        self.state = (self.np_random.uniform(low=-0.6, high=-0.4), 0)
        return np.array(self.state, dtype=np.float32), {}


class LanderEnv(gym.Env):
    """A one-dimensional landing: the state in an array that is changed in place, fuel, and an early return."""

    def __init__(self, gravity: float = -1.62) -> None:
        self.gravity = gravity
        self.low = np.array([0.0, -20.0, 0.0], dtype=np.float64)
        self.high = np.array([100.0, 20.0, 30.0], dtype=np.float64)
        self.observation_space = spaces.Box(self.low, self.high, dtype=np.float64)
        self.action_space = spaces.Discrete(2, start=1)
        self.state = np.zeros(3)

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        self.state[0] = self.np_random.uniform(40, 60)
        self.state[1] = 0.0
        self.state[2] = 30
        return self.state.copy(), {}

    def step(self, action):
        thrust = 0.0
        if action == 2 and self.state[2] > 0:
            thrust = 4.0
            self.state[2] -= 1
        self.state[1] += self.gravity + thrust
        self.state[0] += self.state[1]
        if self.state[0] <= 0:
            speed = abs(self.state[1])
            self.state = np.clip(self.state, self.observation_space.low, self.observation_space.high)  # type: ignore[attr-defined]
            return self.state.copy(), (10.0 if speed < 4 else -speed), True, False, {"speed": speed}
        self.state = np.clip(self.state, self.low, self.high)
        return self.state.copy(), -0.01, False, False, {}
