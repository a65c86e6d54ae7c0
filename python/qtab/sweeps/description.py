"""The study as a store describes it in JSON, and what its runs can hold."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from qtab.config.stored import corrected_settings
from qtab.envs.stored import stored_id
from qtab.results.summary import FINAL_EPISODES

SUMMARY_COLUMNS = ("episodes", "steps", "mean_return", "final_return", "best_return", "terminated_rate")

_TYPES = {"configs": list, "settings": list, "seeds": list, "block": int}


@dataclass(frozen=True)
class Description:
    """The study of a store. Run ``i`` has setting ``i // len(seeds)`` and seed ``seeds[i % len(seeds)]``."""

    configs: Sequence[Mapping[str, Any]]
    """The config of each setting, without the seed, as JSON represents it; a text chooses no module to import."""
    settings: Sequence[Mapping[str, Any]]
    """The values that the grid gives to each setting."""
    seeds: tuple[int, ...]
    """The seeds of every setting."""
    block: int
    """The number of episodes that each point of a learning curve averages."""
    environments: str | None = None
    """JSON text: the environments in detail; None where a store does not say it."""

    @property
    def runs(self) -> int:
        """The number of runs."""
        return len(self.settings) * len(self.seeds)

    @property
    def text(self) -> str:
        """JSON text that is equal for equal studies only. It is part of the store format."""
        return json.dumps({name: getattr(self, name) for name in _TYPES}, sort_keys=True)

    def has_more_seeds(self, other: "Description") -> bool:
        """Returns whether this is the study of another description with further seeds."""
        is_same = replace(self, seeds=()).text == replace(other, seeds=()).text
        return is_same and set(self.seeds) > set(other.seeds)

    def check_run(self, run: int, seed: object, summary: Sequence[object], curve: object, error: object) -> None:
        """Checks that the values of a stored run are possible.

        Raises:
            ValueError: if they are not; the message says which.
        """
        index, position = divmod(run, len(self.seeds))
        config = self.configs[index]
        if seed != str(self.seeds[position]):
            raise ValueError(f"its seed is {self.seeds[position]}, not {_shown(seed)}")
        if not isinstance(curve, bytes) or not (error is None or isinstance(error, str)):
            raise ValueError("its learning curve or its error has the wrong type")
        if error is not None:
            if curve or any(value is not None for value in summary):
                raise ValueError("it failed, but has results")
            return
        numbers = [value for value in summary if isinstance(value, float)]
        if len(numbers) < len(SUMMARY_COLUMNS) or not all(map(math.isfinite, numbers)):
            raise ValueError(f"its results are not finite numbers, but {_shown(tuple(summary))}")
        episodes, steps, mean, final, best, terminated = numbers
        limit = config["max_episode_steps"]
        if episodes != config["episodes"]:
            raise ValueError(f"it has {config['episodes']} episodes, not {episodes:g}")
        if not (episodes <= steps <= episodes * limit and steps.is_integer()):
            raise ValueError(f"{episodes:g} episodes of at most {limit} steps cannot have {steps:g} steps")
        # A mean of equal numbers can lie a few units in the last place above them.
        rounding = 1e-9 * abs(best)
        if max(mean, final) > best + rounding or (episodes <= FINAL_EPISODES and final != mean):
            raise ValueError(f"its mean, final and best return contradict each other: {mean:g}, {final:g}, {best:g}")
        if not 0 <= terminated <= 1:
            raise ValueError(f"its terminated_rate is {terminated:g}")
        if len(curve) != 8 * (config["episodes"] // self.block):
            raise ValueError(f"its learning curve has {len(curve)} bytes")


def read_description(text: str) -> Description:
    """Returns the study that JSON text describes.

    Raises:
        ValueError: if it does not describe a study; the message says why.
    """
    try:
        content = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise ValueError(f"its study is not JSON: {error}") from None
    if not isinstance(content, dict) or not all(type(content.get(name)) is kind for name, kind in _TYPES.items()):
        raise ValueError("its study has no configs, settings, seeds and block")
    configs, settings, seeds, block = (content[name] for name in _TYPES)
    if not settings or len(configs) != len(settings) or block < 1:
        raise ValueError("its study must have one config for each setting and a positive block")
    if not seeds or not all(type(seed) is int and seed >= 0 for seed in seeds) or len(set(seeds)) < len(seeds):
        raise ValueError("its study has bad seeds")
    for config, setting in zip(configs, settings, strict=True):
        if not isinstance(setting, dict) or not setting or setting.keys() != settings[0].keys():
            raise ValueError("the settings of its study do not have the same names")
        if not isinstance(config, dict) or not isinstance(config.get("env"), str):
            raise ValueError("a config of its study has no env")
        for name in ("episodes", "max_episode_steps"):
            if type(config.get(name)) is not int or config[name] < 1:
                raise ValueError(f"a config of its study has bad {name}")
    configs = [{**corrected_settings(config), "env": stored_id(config["env"])} for config in configs]
    return Description(configs, settings, tuple(seeds), block)


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 100 else f"{text[:97]}..."
