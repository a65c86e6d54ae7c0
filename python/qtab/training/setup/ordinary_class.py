"""Ordinary Gymnasium classes under the backend "auto": when they are compiled, and why not.

A compilation with its proof takes about as long as 100,000 steps in Python, so that a class is compiled for a run that
may take as many. Both were timed on the same busy machine, in seconds of CPU time, for classes of the tests:

=============  =======================  =======================  =====================
class          compilation, with proof  loading of stored code   100,000 steps, Python
=============  =======================  =======================  =====================
CliffEnv       2.5                      0.06                     2.8
KeyDoorEnv     4.5                      0.07                     5.6
ThermostatEnv  2.7                      0.2                      2.6
InventoryEnv   3.2                      0.06                     6.6
PendulumEnv    2.7                      0.2                      1.9
=============  =======================  =======================  =====================

The rule depends on settings only, not on times or stored code, and both backends give the same numbers.
"""

import gymnasium as gym

from qtab import _core
from qtab.config import Config
from qtab.envs.class_code import is_of_library
from qtab.envs.external.capsule import compiled_class, has_capsule
from qtab.envs.matching import NotInRustError, time_limit
from qtab.envs.native import check_not_shown

LEAST_STEPS = 100_000
"""The steps from which a class is compiled: episodes times their time limit, times the runs."""

TYPICAL_MAX_STEPS = 1_000
"""The expected maximum number of steps of an episode whose time limit is longer."""

FUNCTION_OF_MASKS = "a function as action_mask may read the environment; write a method action_masks(self) of the class"


def compiled_if_worthwhile(
    env: gym.Env, config: Config, runs: int, not_in_rust: NotInRustError
) -> tuple[_core.ExternalEnv | None, str | None]:
    """Returns an ordinary class as Rust steps it, else None, and the reason with a remedy.

    Args:
        env: The environment, perhaps in the wrappers of ``gymnasium.make``.
        config: The settings given.
        runs: The number of runs with these settings.
        not_in_rust: The reason why Rust does not step it without compilation.
    """
    reason = f"{not_in_rust}; {not_in_rust.remedy}" if not_in_rust.remedy else str(not_in_rust)
    cls = type(env.unwrapped)
    of_this_package = any(base.__module__.partition(".")[0] == "qtab" for base in cls.__mro__)  # as of a TabularEnv
    if has_capsule(env) or is_of_library(cls) or of_this_package:
        return None, reason
    from qtab.compilation.functional import is_installed

    if not is_installed():
        return None, f"{not_in_rust}; with Numba (pip install 'qtab[numba]'), such a class can be compiled"
    if callable(config.action_mask):
        return None, f"{not_in_rust}, and {FUNCTION_OF_MASKS}"
    if counted_steps(env, config) * runs < LEAST_STEPS:
        return None, f"{not_in_rust}, and it is compiled only for runs that may take {LEAST_STEPS:,} steps or more"
    try:
        check_not_shown(env)
        return compiled_class(env, needs_masks=config.action_mask is True), None
    except NotInRustError as error:
        return None, f"{error}; {error.remedy}" if error.remedy else str(error)
    except Exception as error:  # of Numba, such as an import that fails; Python can step the environment
        return None, f"it could not be compiled: {type(error).__name__}: {error}"


def counted_steps(env: gym.Env, config: Config) -> int:
    """Returns the steps of a run as they count: its episodes times their time limit, or ``TYPICAL_MAX_STEPS``."""
    limits = [one for one in (config.max_episode_steps, time_limit(env)) if one is not None]
    return config.episodes * min([*limits, TYPICAL_MAX_STEPS])
