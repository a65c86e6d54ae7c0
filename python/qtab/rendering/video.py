"""Videos of recorded episodes, written by Gymnasium's RecordVideo."""

import os
import re
import warnings
from pathlib import Path
from typing import Any

from qtab._utils.extras import missing
from qtab._utils.files import check_writable
from qtab.config import Config
from qtab.rendering.replay import make_render_env, replay_all
from qtab.rendering.window import is_headless
from qtab.results.run import Run


class VideoRecorder:
    """Writes videos into a folder. The constructor raises everything that can be known before training.

    Args:
        config: The resolved config of the run.
        folder: Where the videos are written; created if it does not exist.

    Raises:
        ModuleNotFoundError: without moviepy; the message names the ``pip install``.
        OSError: if the folder cannot be written to.
        ValueError: if the environment cannot be rendered as images.
        gymnasium.error.Error: from Gymnasium, if rendering fails.
    """

    def __init__(self, config: Config, folder: Path) -> None:
        try:
            import moviepy  # noqa: F401
        except ModuleNotFoundError as error:
            raise missing(error, "video") from None
        from gymnasium.wrappers import RecordVideo

        if is_headless():
            os.environ["SDL_VIDEODRIVER"] = "dummy"  # keeps SDL from searching for a display and printing errors
        env = make_render_env(config, "rgb_array")
        try:
            env.reset()
            env.render()
            _create_folder(folder)
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # RecordVideo warns if the folder exists
                self._env: Any = RecordVideo(
                    env, str(folder), episode_trigger=lambda _: True, name_prefix=re.split("[/:]", config.env)[-1]
                )
        except BaseException:
            env.close()
            raise

    def record(self, run: Run) -> int:
        """Writes a video of each recorded episode, and returns the number with another return than in training."""
        if run.recordings:
            self._env.episode_id = run.recordings[0].episode
        return replay_all(self._env, run)

    def close(self) -> None:
        """Finishes the last video and closes the environment."""
        self._env.close()


def _create_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise type(error)(
            f"record must be a folder that can be created, got {str(folder)!r}: {error.strerror}"
        ) from None
    check_writable("record", folder / "video.mp4")
