"""The last episodes are replayed after training: the same episodes, without an effect on the table."""

from contextlib import closing
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest

import qtab as package
from qtab.cli import outputs
from qtab.rendering import video
from qtab.rendering.replay import make_render_env, replay_all, replay_episode
from qtab.rendering.video import VideoRecorder
from support.processes.command import qtab, qtab_here, refused


@pytest.mark.parametrize("backend", ["rust", "gymnasium"])
@pytest.mark.parametrize("bit_generator", ["PCG64", "MT19937"])
def test_recordings_play_the_same_returns_and_lengths_in_gymnasium(backend: Any, bit_generator: Any) -> None:
    run = package.train(
        *("MountainCar-v0",), episodes=20, seed=5, record=10, backend=backend, bit_generator=bit_generator
    )
    assert [recording.episode for recording in run.recordings] == list(range(10, 20))
    env = gym.make("MountainCar-v0")
    for recording in run.recordings:
        assert len(recording.actions) == run.episode_lengths[recording.episode]
        assert replay_episode(env, recording) == run.episode_returns[recording.episode]
    assert replay_all(env, run) == 0


def test_a_recording_of_the_first_episode_starts_from_the_seed() -> None:
    run = package.train("MountainCar-v0", episodes=3, seed=9, record=3)
    env = gym.make("MountainCar-v0")
    seeded, _ = gym.make("MountainCar-v0").reset(seed=9)
    starts = []
    reset = env.unwrapped.reset

    def watched(**kwargs: Any) -> Any:
        start = reset(**kwargs)
        starts.append(start[0])
        return start

    env.unwrapped.reset = watched  # type: ignore[method-assign]
    replay_all(env, run)
    assert starts[0].tobytes() == seeded.tobytes()


def test_recording_more_episodes_than_there_are_records_all() -> None:
    assert len(package.train("MountainCar-v0", episodes=4, seed=0, record=20).recordings) == 4


def test_episodes_that_differ_are_counted() -> None:
    run = package.train("MountainCar-v0", episodes=3, seed=0, record=3)
    run.episode_returns[1] -= 1
    assert replay_all(gym.make("MountainCar-v0"), run) == 1


@pytest.mark.parametrize(
    ("env", "settings"),
    [
        ("qtab/BlockingMaze-v0", {"env_kwargs": {"change_after": 40}, "episodes": 12, "max_episode_steps": 30}),
        ("qtab/KArmedBandit-v0", {"episodes": 12, "max_episode_steps": 1}),
    ],
)
def test_environments_that_change_or_draw_a_problem_are_replayed_as_they_were(env: str, settings: Any) -> None:
    run = package.train(env, seed=4, record=3, epsilon=1.0, epsilon_schedule="constant", **settings)
    made = gym.make(env, max_episode_steps=run.config.max_episode_steps, **run.config.env_kwargs)
    steps: list[int] = []
    take = made.unwrapped.step

    def watched(action: Any) -> Any:
        steps.append(getattr(made.unwrapped, "total_steps", 0))
        return take(action)

    made.unwrapped.step = watched  # type: ignore[method-assign]
    assert replay_all(made, run) == 0
    if "Maze" in env:
        assert steps[0] == run.episode_lengths[:9].sum() > 40


def test_the_render_environment_has_the_time_limit_and_keyword_arguments_of_the_run() -> None:
    config = package.train("MountainCar-v0", episodes=1, max_episode_steps=7, env_kwargs={"goal_velocity": 0.01}).config
    env = make_render_env(config, "rgb_array")
    assert env.unwrapped.goal_velocity == 0.01  # type: ignore[attr-defined]
    run = package.train("MountainCar-v0", episodes=2, seed=0, record=2, max_episode_steps=7)
    assert replay_all(env, run) == 0


def test_an_environment_that_cannot_be_rendered_is_refused_before_training(tmp_path: Path) -> None:
    line = refused("train", "toys:Walk-v0", "--scale", "1", "--record", "videos", cwd=tmp_path, run=qtab)
    assert "cannot be rendered" in line


def test_pictures_that_no_video_can_hold_are_refused_before_training(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    config = package.train("FrozenLake-v1", episodes=1, seed=0).config
    env = gym.make("FrozenLake-v1", render_mode="rgb_array", disable_env_checker=True)
    monkeypatch.setattr(env.unwrapped, "render", lambda: np.zeros((4, 4, 3)))
    monkeypatch.setattr(video, "make_render_env", lambda *_: env)
    with pytest.raises(TypeError, match=r"env\.render\(\) must return a \(height, width, 3\) array of uint8"):
        VideoRecorder(config, tmp_path / "videos")
    assert not (tmp_path / "videos").exists()


def test_an_interrupted_call_leaves_only_complete_videos(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run = package.train("FrozenLake-v1", episodes=3, seed=0, record=2)

    def write(_: Any, path: Path) -> None:
        path.write_bytes(b"part")
        if list(tmp_path.glob("Frozen*.mp4")):
            raise KeyboardInterrupt

    monkeypatch.setattr(video, "write_mp4", write)
    with closing(VideoRecorder(run.config, tmp_path)) as recorder, pytest.raises(KeyboardInterrupt):
        recorder.record(run)
    assert [file.name for file in tmp_path.iterdir()] == ["FrozenLake-v1-episode-2.mp4"]


@pytest.mark.slow
def test_record_writes_the_last_episodes_as_videos_and_does_not_change_the_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import imageio_ffmpeg  # type: ignore[import-untyped]

    assert outputs.DEFAULT_SHOWN == 20
    monkeypatch.setattr(outputs, "DEFAULT_SHOWN", 4)
    common = ["train", "--seed", "1", "--episodes", "50", "--max-episode-steps", "20"]
    done = qtab_here(*common, "--save", "with.npz", "--record", "deep/videos", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    assert qtab_here(*common, "--save", "without.npz", cwd=tmp_path).returncode == 0
    one, other = package.load(tmp_path / "with.npz"), package.load(tmp_path / "without.npz")
    assert one.q_table.tobytes() == other.q_table.tobytes()
    assert one.episode_returns.tobytes() == other.episode_returns.tobytes()
    videos = sorted((tmp_path / "deep" / "videos").iterdir())
    assert [video.name for video in videos] == [f"MountainCar-v0-episode-{number}.mp4" for number in range(47, 51)]
    frames, _ = imageio_ffmpeg.count_frames_and_secs(str(videos[0]))
    assert frames == 21  # one for the reset, and one for each step


def test_watch_is_refused_before_training_without_a_display(tmp_path: Path) -> None:
    drivers: list[Any] = [{}, {"SDL_VIDEODRIVER": "dummy"}, {"SDL_VIDEODRIVER": "offscreen"}]
    for variables in drivers:
        line = refused("train", "--watch", "3", "--save", "run.npz", cwd=tmp_path, **variables)
        assert "--record FOLDER" in line


def test_a_window_shows_the_same_episodes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    run = package.train("MountainCar-v0", episodes=5, seed=0, record=2, max_episode_steps=10)
    env = make_render_env(run.config, "human")
    env.metadata["render_fps"] = 1000
    assert replay_all(env, run) == 0
    env.close()
    assert np.isfinite(run.q_table).all()
