"""The algorithm of a config with its options."""

from types import SimpleNamespace

from qtab._utils.checks import required
from qtab.config.config import Config
from qtab.config.options import options_of


def algorithm_options(config: Config) -> SimpleNamespace:
    """Returns the options of the algorithm of a complete config, as attributes.

    Raises:
        ValueError: if one of them is None.
    """
    names = options_of("algorithm", config.algorithm)
    return SimpleNamespace(**{name: required(name, getattr(config, name)) for name in names})
