"""Steps an environment in Python and in compiled code, and compares every byte."""

from typing import Any

import numpy as np

from qtab.compilation.functional import compiled_env, state_from
from qtab.compilation.interface.compiled_env import Stepper
from qtab.compilation.interface.qtab_env import FAILED
from qtab.compilation.layouts.value_layout import encode


def assert_equal_steps(env: Any, seed: int, actions_seed: int, steps: int) -> None:
    """Fails unless the compiled functions and Gymnasium's interface of the environment give the same bytes.

    Args:
        env: A functional environment.
        seed: The seed of the episodes.
        actions_seed: The seed of the actions, which are chosen among those of the mask.
        steps: The number of steps and resets.
    """
    compiled, parameters = compiled_env(env)
    stepper = Stepper(compiled, parameters.memory(), np.random.PCG64(seed))
    choose = np.random.default_rng(actions_seed)
    begins, given_seed = True, [seed]
    for _ in range(steps):
        if begins:
            observation, info = env.reset(seed=given_seed.pop() if given_seed else None)
            assert stepper.reset() == 0
            terminated = False
        else:
            mask = info.get("action_mask", np.ones(compiled.num_actions))
            action = int(choose.choice(np.flatnonzero(mask)))
            observation, reward, terminated, _, info = env.step(int(env.action_space.start) + action)
            assert stepper.step(action) == int(terminated)
            assert stepper.reward.tobytes() == np.float64(reward).tobytes()
        assert stepper.observation.tobytes() == compiled.observation.numbers(observation).tobytes()
        assert stepper.bit_generator.state == env.np_random.bit_generator.state
        assert encode(compiled.state, env.state).tobytes() == stepper.state.tobytes()
        if "action_mask" in info:
            assert stepper.action_mask.tolist() == info["action_mask"].tolist()
        before = stepper.observation.copy()
        stepper.observation[:] = 0
        assert stepper.observe() != FAILED
        assert stepper.observation.tobytes() == before.tobytes()
        restored = encode(compiled.state, state_from(env, compiled, stepper.state.tobytes()))
        assert restored.tobytes() == stepper.state.tobytes()
        begins = terminated or choose.random() < 0.01
