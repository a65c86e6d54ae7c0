"""The optimum of a run's environment, where it takes less than a second."""

from qtab.config import Config
from qtab.config.origin import trained_on
from qtab.envs.goals import has_quick_optimum
from qtab.planning.optimum import Optimum
from qtab.planning.solve import optimum


def quick_optimum(config: Config, n_rows: int, n_actions: int) -> Optimum | None:
    """Returns the optimum of a resolved config's environment; None where no table is known, or it would take long.

    Args:
        config: The config.
        n_rows: The number of rows of the run's table.
        n_actions: The number of actions.
    """
    known = trained_on(config)
    is_changed = known is not None and (known.table is not None or bool(known.wrappers))
    if is_changed or not has_quick_optimum(config, n_rows, n_actions):
        return None
    return optimum(config.env, env_kwargs=config.env_kwargs, max_episode_steps=config.max_episode_steps)
