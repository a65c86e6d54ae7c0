"""The settings of a run that were derived, not given."""

from qtab.config import Config
from qtab.config.options import is_set
from qtab.discretizers import Discretizer


def derived_settings(asked: Config, config: Config, discretizer: Discretizer) -> frozenset[str]:
    """Returns the settings that were not given, and that follow from the environment or from other settings.

    Args:
        asked: The settings that were given, and those of the preset.
        config: All settings of the run.
        discretizer: That of the run.
    """
    names = {"max_episode_steps", *discretizer.settings()}
    derived = {name for name in names if not is_set(getattr(asked, name)) and is_set(getattr(config, name))}
    if asked.backend == "auto":
        derived.add("backend")
    if asked.discretizer == "round" and config.discretizer == "identity":
        derived.add("discretizer")
    return frozenset(derived)
