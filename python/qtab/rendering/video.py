"""Videos of recorded episodes."""

import os
import re
from pathlib import Path

import gymnasium as gym

from qtab._utils.files import check_writable, replacing
from qtab.config import Config
from qtab.rendering.formats import ffmpeg, write_mp4
from qtab.rendering.frames import Frames, frames_per_second
from qtab.rendering.replay import make_render_env, replay_all, replay_episode
from qtab.rendering.window import is_headless
from qtab.results.run import Recording, Run


class VideoRecorder:
    """Writes videos into a folder. The constructor raises all errors that can be known before training.

    Args:
        config: The resolved config of the run.
        folder: The folder to write the videos to, created if it does not exist.

    Raises:
        ModuleNotFoundError: without imageio-ffmpeg; the message names the ``pip install``.
        OSError: if the folder cannot be written to.
        TypeError: if the environment does not render (height, width, 3) arrays of uint8.
        ValueError: if the environment cannot be rendered as images.
        gymnasium.error.Error: from Gymnasium, if rendering fails.
    """

    def __init__(self, config: Config, folder: Path) -> None:
        ffmpeg()
        if is_headless():
            os.environ["SDL_VIDEODRIVER"] = "dummy"  # keeps SDL from searching for a display and printing errors
        self._folder, self._name = folder, re.split("[/:]", config.env)[-1]
        self._env = make_render_env(config, "rgb_array")
        try:
            self._env.reset()
            # A picture that no video can hold raises here, before training.
            Frames(frames_per_second(self._env, None)).append(self._env.render(), "")
            _create_folder(folder)
        except BaseException:
            self.close()
            raise

    def record(self, run: Run) -> int:
        """Writes a video of each recorded episode, and returns the number with another return than in training."""
        return replay_all(self._env, run, replay=self._film)

    def _film(self, env: gym.Env, recording: Recording) -> float:
        number = recording.episode + 1
        frames = Frames(frames_per_second(env, None))
        returned = replay_episode(env, recording, lambda: frames.append(env.render(), f"episode {number}"))
        with replacing(self._folder / f"{self._name}-episode-{number}.mp4") as temporary:
            write_mp4(frames, temporary)
        return returned

    def close(self) -> None:
        """Closes the environment."""
        self._env.close()


def _create_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise type(error)(
            f"record must be a folder that can be created, got {str(folder)!r}: {error.strerror}"
        ) from None
    check_writable("record", folder / "video.mp4")
