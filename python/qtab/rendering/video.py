"""The last episodes of a run as videos, through Gymnasium's RecordVideo."""

import os
import re
import warnings
from pathlib import Path
from typing import Any

from qtab._utils.extras import missing
from qtab._utils.files import check_writable
from qtab.config import Config
from qtab.rendering.replay import make_render_env, replay_all
from qtab.rendering.window import headless
from qtab.results.run import Run


class Recorder:
    """A folder for videos, and an environment that draws: all that can be refused is refused when it is made.

    Raises:
        ModuleNotFoundError: without moviepy; it names the ``pip install``.
        OSError: if the folder cannot be written to.
        ValueError: if the environment has no picture.
        gymnasium.error.Error: Gymnasium's own, if it cannot draw.
    """

    def __init__(self, config: Config, folder: Path) -> None:
        try:
            import moviepy  # noqa: F401
        except ModuleNotFoundError as error:
            raise missing(error, "video") from None
        from gymnasium.wrappers import RecordVideo

        if headless():
            os.environ["SDL_VIDEODRIVER"] = "dummy"  # SDL would look for a display all the same, and complain
        env = make_render_env(config, "rgb_array")
        try:
            env.reset()
            env.render()
            _make(folder)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # that the folder is there
                self._env: Any = RecordVideo(
                    env, str(folder), episode_trigger=lambda _: True, name_prefix=re.split("[/:]", config.env)[-1]
                )
        except BaseException:
            env.close()
            raise

    def record(self, run: Run) -> int:
        """Writes a video for each recorded episode, numbered from 1; returns how many differ from training."""
        if run.recordings:
            self._env.episode_id = run.recordings[0].episode
        return replay_all(self._env, run)

    def close(self) -> None:
        """Writes what is unwritten and closes the environment."""
        self._env.close()


def _make(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise type(error)(f"record must be a folder that can be made, got {str(folder)!r}: {error.strerror}") from None
    check_writable("record", folder / "video.mp4")
