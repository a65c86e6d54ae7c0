"""``qtab.play``: greedy episodes rendered by Gymnasium, the same as those of ``qtab.evaluate``."""

import re
import sys
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.envs.toy_text.frozen_lake import FrozenLakeEnv

import qtab
from qtab.rendering import play as module
from support.parity import assert_same_run

LAKE: dict[str, Any] = {"episodes": 200, "seed": 0, "max_episode_steps": 20}


def lake(**settings: Any) -> qtab.Run:
    return qtab.train("FrozenLake-v1", **{**LAKE, **settings})


def pygame_is_closed() -> bool:
    return not sys.modules["pygame"].display.get_init()


@pytest.mark.parametrize(
    ("env", "settings"),
    [
        ("MountainCar-v0", {"algorithm": "double_q_learning", "discretizer": "tiles"}),
        ("CartPole-v1", {}),
        ("Acrobot-v1", {}),
        ("Pendulum-v1", {"discretizer": "bins", "bins": 8, "actions": (-2, 0, 2)}),
        ("FrozenLake-v1", {"env_kwargs": {"map_name": "8x8", "is_slippery": False}}),
        ("CliffWalking-v1", {}),
        ("Taxi-v4", {}),
        ("Blackjack-v1", {}),
        ("qtab/MountainCar-v0", {}),
        ("FrozenLake-v1", {"backend": "gymnasium"}),
    ],
)
def test_the_episodes_are_those_of_evaluate(env: str, settings: dict[str, Any]) -> None:
    run = qtab.train(env, **{"episodes": 30, "seed": 0, "max_episode_steps": 12, **settings})
    played, evaluated = qtab.play(run, 3, seed=5, window=False), qtab.evaluate(run, 3, seed=5)
    for name in ("returns", "lengths", "terminated"):
        assert getattr(played, name).tobytes() == getattr(evaluated, name).tobytes(), name
    assert played.seed == evaluated.seed == 5
    assert pygame_is_closed()


def test_the_pictures_are_gymnasiums() -> None:
    run = lake()
    played = qtab.play(run, 2, seed=3, window=False)
    expected: list[Any] = []
    with gym.make("FrozenLake-v1", render_mode="rgb_array", max_episode_steps=20) as env:
        for episode in range(2):
            observation, _ = env.reset(seed=3 if episode == 0 else None)
            expected.append(env.render())
            over = False
            while not over:
                observation, _, terminated, truncated, _ = env.step(run.predict(observation)[0])
                expected.append(env.render())
                over = terminated or truncated
    pictures = list(played.film.frames())
    assert len(pictures) == played.lengths.sum() + 2 == len(expected)
    assert all(np.array_equal(picture, frame) for picture, frame in zip(pictures, expected, strict=True))
    assert played.film.frames().fps == 4


def test_the_run_is_not_changed() -> None:
    run, same = lake(), lake()
    qtab.play(run, seed=1, window=False)
    assert_same_run(run, same)


def test_an_optimum_plays_its_policy() -> None:
    best = qtab.optimum("CliffWalking-v1", max_episode_steps=50)
    assert qtab.play(best, seed=0, window=False).returns.tolist() == [-13.0]


def test_a_seed_is_drawn_and_recorded() -> None:
    run = lake()
    played = qtab.play(run, window=False)
    assert played.returns == qtab.play(run, seed=played.seed, window=False).returns
    assert re.fullmatch(r"<Playback of FrozenLake-v1, 1 episode, seed \d+: return [01] in \d+ steps>", repr(played))


def test_videos_can_be_read_again(tmp_path: Path) -> None:
    import imageio_ffmpeg  # type: ignore[import-untyped]
    from PIL import Image

    played = qtab.play(lake(), seed=3, window=False)
    frames = played.film.frames()
    for name in ("lake.mp4", "lake.GIF", "lake.html"):
        played.save(tmp_path / name)
    count, seconds = imageio_ffmpeg.count_frames_and_secs(str(tmp_path / "lake.mp4"))
    assert count == len(frames)
    assert seconds == pytest.approx(len(frames) / 4, abs=0.3)
    with Image.open(tmp_path / "lake.GIF") as gif:
        durations = []
        for index in range(gif.n_frames):
            gif.seek(index)
            durations.append(gif.info["duration"])
        assert gif.size == frames.size
        assert sum(durations) == 1000 * len(frames) / 4  # equal pictures in turn are stored once
        gif.seek(0)
        assert np.abs(np.asarray(gif.convert("RGB")).astype(int) - next(iter(frames))).mean() < 3
    text = (tmp_path / "lake.html").read_text()
    assert 'src="data:video/mp4;base64,' in text
    assert not re.search(r"https?://", text)
    assert played.summary in text


def test_a_notebook_shows_a_video_or_without_ffmpeg_pictures_with_a_slider(monkeypatch: pytest.MonkeyPatch) -> None:
    run = lake()
    assert "<video controls" in qtab.play(run, seed=3, window=False)._repr_html_()
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    played = qtab.play(run, seed=3, window=False)
    text = played._repr_html_()
    assert text.count("data:image/png;base64,") == len(played.film.frames())
    assert text.count("display:none") == len(played.film.frames()) - 1
    assert f'max="{len(played.film.frames()) - 1}"' in text
    assert text is played._repr_html_()  # made once


@pytest.fixture
def screen(monkeypatch: pytest.MonkeyPatch) -> None:
    """SDL draws into memory, which counts as a display here."""
    monkeypatch.setattr(module, "display_problem", lambda: None)


def test_a_window_shows_the_same_episodes_which_can_be_saved_later(screen: None) -> None:
    run = lake()
    fps = FrozenLakeEnv.metadata["render_fps"]
    played = qtab.play(run, 2, seed=3, fps=1000)
    assert pygame_is_closed()
    assert FrozenLakeEnv.metadata["render_fps"] == fps
    assert played.returns.tobytes() == qtab.evaluate(run, 2, seed=3).returns.tobytes()
    assert len(played.film.frames()) == played.lengths.sum() + 2


def test_closing_the_window_ends_the_playing(screen: None, monkeypatch: pytest.MonkeyPatch) -> None:
    import pygame

    steps = 0
    step = FrozenLakeEnv.step

    def closing_at_the_third(self: Any, action: Any) -> Any:
        nonlocal steps
        steps += 1
        if steps == 3:
            pygame.event.post(pygame.event.Event(pygame.QUIT))
        return step(self, action)

    monkeypatch.setattr(FrozenLakeEnv, "step", closing_at_the_third)
    played = qtab.play(lake(backend="gymnasium", episodes=1, max_episode_steps=1), 5, max_episode_steps=2, fps=1000)
    assert steps == 3
    assert len(played.returns) <= 1
    assert pygame_is_closed()


def test_an_error_of_the_environment_closes_it(monkeypatch: pytest.MonkeyPatch) -> None:
    run = lake()

    def broken(self: Any, action: Any) -> Any:
        raise RuntimeError("the motor is broken")

    monkeypatch.setattr(gym.wrappers.TimeLimit, "step", broken)
    with pytest.raises(RuntimeError, match="the motor is broken"):
        qtab.play(run, seed=0, window=False)
    assert pygame_is_closed()


def test_without_a_display_nothing_is_shown_and_a_message_says_so(caplog: pytest.LogCaptureFixture) -> None:
    run = lake()
    qtab.play(run, seed=0)
    assert "no window is shown (SDL draws to 'dummy'); .save('agent.mp4') writes the video" in caplog.text


@pytest.mark.filterwarnings("ignore:.*No render fps")
def test_without_pygame_an_environment_that_does_not_need_it_is_shown_without_a_window(
    caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = qtab.train(Corridor(), episodes=2, seed=0, max_episode_steps=5)
    monkeypatch.setitem(sys.modules, "pygame", None)
    assert len(qtab.play(run, seed=0, env=Corridor("rgb_array")).returns) == 1
    with pytest.raises(ModuleNotFoundError, match=r"pip install .*"):
        qtab.play(run, env=Corridor("rgb_array"), window=True)
    with pytest.raises(gym.error.DependencyNotInstalled, match="pip install"):
        qtab.play(lake())
    assert "no window is shown" not in caplog.text
    spec = gym.envs.registration.EnvSpec("Corridor-v0", Corridor)  # type: ignore[arg-type]
    assert len(qtab.play(run, seed=0, env=spec).returns) == 1
    assert "no window is shown (this needs pygame" in caplog.text


class Corridor(gym.Env[Any, Any]):
    """Two cells; a move to the right ends the episode."""

    metadata = {"render_modes": ["rgb_array"]}  # noqa: RUF012 - Gymnasium's convention
    observation_space = gym.spaces.Discrete(2)
    action_space = gym.spaces.Discrete(2)
    picture: Any = np.full((5, 7, 3), 200, np.uint8)

    def __init__(self, render_mode: str | None = None) -> None:
        self.render_mode = render_mode
        self.closed = 0

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any:
        super().reset(seed=seed)
        return int(self.np_random.integers(2)), {}

    def step(self, action: Any) -> Any:
        return 0, -1.0, bool(action == 1), False, {}

    def render(self) -> Any:
        return self.picture

    def close(self) -> None:
        self.closed += 1


def test_an_environment_without_an_id_is_given(tmp_path: Path) -> None:
    run = qtab.train(Corridor(), episodes=20, seed=0, max_episode_steps=5)
    env = Corridor("rgb_array")
    played = qtab.play(run, 2, seed=1, env=env)
    assert env.closed == 0
    assert played.returns.tobytes() == qtab.evaluate(run, 2, seed=1, env=Corridor()).returns.tobytes()
    played.save(tmp_path / "odd.mp4")  # 7 x 5 pixels: the format needs even sizes


@pytest.mark.parametrize(
    ("picture", "message"),
    [
        (None, r"env.render\(\) must return a \(height, width, 3\) array of uint8, got None"),
        (np.zeros((2, 2)), "array of uint8"),
        (np.zeros((2, 2, 4), np.uint8), r"of shape \(height, width, 3\), got \(2, 2, 4\)"),
    ],
)
def test_a_wrong_picture_is_refused(picture: Any, message: str, monkeypatch: pytest.MonkeyPatch) -> None:
    run = qtab.train(Corridor(), episodes=2, seed=0, max_episode_steps=5)
    monkeypatch.setattr(Corridor, "picture", picture)
    with pytest.raises((TypeError, ValueError), match=message):
        qtab.play(run, env=Corridor("rgb_array"))


RUN = lake(episodes=2)
TABLE = qtab.TabularEnv({0: {0: [(1.0, 1, 1.0, True)]}, 1: {0: [(1.0, 1, 0.0, True)]}}, [1.0, 0.0])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"episodes": 0}, "episodes must be an integer of at least 1, got 0"),
        ({"seed": -1}, "seed must be an integer of at least 0, got -1"),
        ({"fps": 0}, r"fps must lie in \[0.01, 1000\], got 0"),
        ({"window": 1}, "window must be True or False, got 1"),
        ({"window": True}, r"window needs a display \(SDL draws to 'dummy'\)"),
        ({"max_episode_steps": 0}, "max_episode_steps must be an integer of at least 1, got 0"),
        ({"env": 3}, "env must be an environment id"),
        ({"env": "Taxi-v4"}, "env must have the spaces of the run's FrozenLake-v1, got Taxi-v4"),
        ({"env": gym.make("FrozenLake-v1")}, "env must be made with render_mode='rgb_array', got None"),
        ({"run": "run.npz"}, "run must be a Run or an Optimum, got 'run.npz'; qtab.load reads one"),
        ({"run": qtab.train(TABLE, episodes=2, seed=0, max_episode_steps=5)}, "is not registered.*pass env="),
        (
            {"run": qtab.train(TABLE, episodes=2, seed=0, max_episode_steps=5), "env": TABLE},
            "TabularEnv cannot be rendered as 'rgb_array'; its render modes are: none",
        ),
        ({"epsiodes": 2}, r"unknown argument 'epsiodes' \(did you mean 'episodes'\?\)"),
    ],
)
def test_wrong_arguments_are_refused(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises((TypeError, ValueError, gym.error.Error), match=message):
        qtab.play(**{"run": RUN, "window": False, **arguments})


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ("agent.avi", "path must end in one of .mp4, .gif, .html, got 'agent.avi'"),
        ("agent.mp5", r"did you mean '.mp4'\?"),
        ("agent", "path must end in one of"),
        ("none/agent.gif", "path must be a file that can be written"),
        (3, "path must be a path, got 3"),
    ],
)
def test_wrong_paths_are_refused(path: Any, message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises((TypeError, ValueError, OSError), match=message):
        qtab.play(RUN, window=False).save(path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("ending", "library"), [("mp4", "imageio_ffmpeg"), ("gif", "PIL")])
def test_a_missing_library_is_named(ending: str, library: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    played = qtab.play(RUN, window=False)
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(ModuleNotFoundError, match=r"pip install "):
        played.save(tmp_path / f"agent.{ending}")
