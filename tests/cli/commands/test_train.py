"""The ``qtab`` command: what it prints, what it writes, how it fails."""

import importlib.metadata
import re
import signal
import subprocess
from pathlib import Path

import numpy as np
import pytest

import qtab as package
from support.processes.command import QTAB, environment, qtab, qtab_here, refused
from support.processes.posix import posix_only


def test_train_prints_the_articles_averages_and_saves_the_run(tmp_path: Path) -> None:
    done = qtab("train", "--seed", "3", "--episodes", "450", "--save", "run.npz", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    run = package.load(tmp_path / "run.npz")
    same = package.train("MountainCar-v0", seed=3, episodes=450)
    assert run.q_table.tobytes() == same.q_table.tobytes()
    printed = re.findall(r"^Episode (\d+) Average Reward: (.*)$", done.stdout, re.M)
    assert printed == [(str(100 * i + 100), str(mean)) for i, mean in enumerate(same.mean_returns(100).tolist())]
    header, *_ = done.stdout.splitlines()
    assert header == "MountainCar-v0 in Rust, preset article, 450 episodes, seed 3"
    assert f"last 100 episodes: {same.episode_returns[-100:].mean():.2f}" in done.stdout
    assert done.stdout.splitlines()[-1] == "Saved the run to run.npz"


def test_every_setting_is_a_flag_and_help_shows_the_preset(tmp_path: Path) -> None:
    done = qtab_here("train", "--help", cwd=tmp_path)
    assert done.returncode == 0
    for name in package.Config.__dataclass_fields__:
        if name != "env":
            assert f"--{name.replace('_', '-')} " in done.stdout
    words = " ".join(done.stdout.split())
    assert "default: 10.0 100.0" in words
    assert "default: MountainCar-v0" in words


def test_help_shows_the_settings_of_the_file(tmp_path: Path) -> None:
    (tmp_path / "run.toml").write_text("episodes = 123")
    assert "123" in qtab_here("train", "--config", "run.toml", "--help", cwd=tmp_path).stdout


@pytest.mark.parametrize(
    "arguments",
    [
        ["qtab/MountainCar-v0", "--episodes", "5"],
        ["--episodes", "5", "qtab/MountainCar-v0"],
        ["--env", "qtab/MountainCar-v0", "--episodes", "5"],
        ["--episodes=5", "--env=qtab/MountainCar-v0"],
    ],
)
def test_the_environment_is_named_first_or_last_or_by_its_flag(tmp_path: Path, arguments: list[str]) -> None:
    done = qtab_here("train", *arguments, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("qtab/MountainCar-v0 in Rust, preset article, 5 episodes")


def test_flags_win_over_the_file_and_the_file_over_the_preset(tmp_path: Path) -> None:
    (tmp_path / "run.toml").write_text(
        'env = "qtab/MountainCar-v0"\nepisodes = 7\nseed = 1\nlearning_rate = 0.5\nscale = [5, 50]\n'
        "initial_q = [-2, 0]\nmin_epsilon = 0.1\n[env_kwargs]\ngoal_velocity = 0.01\n"
    )
    done = qtab_here(
        "train", "--config", "run.toml", "--seed", "2", "--discount", "0.99", "--save", "a.npz", cwd=tmp_path
    )
    assert done.returncode == 0, done.stderr
    config = package.load(tmp_path / "a.npz").config
    assert (config.env, config.episodes, config.seed, config.learning_rate) == ("qtab/MountainCar-v0", 7, 2, 0.5)
    assert (config.scale, config.initial_q, config.min_epsilon) == ((5.0, 50.0), (-2.0, 0.0), 0.1)
    assert (config.discount, config.terminal_update, config.env_kwargs) == (0.99, "assign", {"goal_velocity": 0.01})


def test_env_kwargs_and_negative_ranges_are_parsed(tmp_path: Path) -> None:
    done = qtab_here(
        *("train", "--episodes", "3", "--env-kwargs", "goal_velocity", "-0.01", "--initial-q", "-2", "-1"),
        *("--save", "a.npz"),
        cwd=tmp_path,
    )
    assert done.returncode == 0, done.stderr
    config = package.load(tmp_path / "a.npz").config
    assert (config.env_kwargs, config.initial_q) == ({"goal_velocity": -0.01}, (-2.0, -1.0))


def test_training_continues_from_the_table_of_a_file(tmp_path: Path) -> None:
    first = package.train("MountainCar-v0", seed=0, episodes=50)
    first.save(tmp_path / "first.npz")
    for settings in (["--initial-q", "first.npz"], ["--config", "run.toml"]):
        (tmp_path / "run.toml").write_text('initial_q = "first.npz"')
        done = qtab_here("train", "--episodes", "20", "--seed", "1", *settings, "--save", "more.npz", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        more = package.train("MountainCar-v0", seed=1, episodes=20, initial_q=first.q_table)
        assert package.load(tmp_path / "more.npz").q_table.tobytes() == more.q_table.tobytes()


@pytest.mark.slow
def test_the_header_reports_python_stepping_and_the_default_time_limit(tmp_path: Path) -> None:
    done = qtab("train", "toys:Walk-v0", "--scale", "1", "--episodes", "3", "--seed", "0", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    first, second, *_ = done.stdout.splitlines()
    assert first == "toys:Walk-v0 stepped by Gymnasium in Python, no preset, 3 episodes, seed 0"
    assert "no time limit" in second
    assert "10,000 steps" in second
    for limit, is_reported in ([], True), (["--max-episode-steps", "9"], False):
        done = qtab_here("train", "CliffWalking-v1", "--episodes", "3", *limit, cwd=tmp_path)
        assert ("no time limit" in done.stdout) is is_reported


NEWEST = "Using the latest versioned environment `CliffWalking-v1`"


@pytest.mark.parametrize("arguments", [["--seed", "0", "CliffWalking"], ["--env", "CliffWalking"]])
def test_an_id_without_a_version_means_the_newest_with_its_preset(tmp_path: Path, arguments: list[str]) -> None:
    with pytest.warns(UserWarning, match=NEWEST):
        done = qtab_here("train", *arguments, "--episodes", "2", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("CliffWalking-v1 in Rust, preset tuned, 2 episodes, seed ")


@pytest.mark.slow
def test_the_version_that_was_chosen_is_reported(tmp_path: Path) -> None:
    done = qtab("train", "CliffWalking", "--episodes", "2", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("CliffWalking-v1 in Rust, preset tuned, 2 episodes, seed ")
    assert NEWEST in done.stderr
    # The header has reported it.
    assert "no time limit" not in done.stderr


@pytest.mark.parametrize("name", ["rewards.jpg", "rewards.png", "rewards.pdf", "rewards.svg"])
def test_plots_are_written_in_the_format_of_their_extension(tmp_path: Path, name: str) -> None:
    done = qtab_here("train", "--episodes", "300", "--plot", name, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    starts = {"jpg": b"\xff\xd8\xff", "png": b"\x89PNG", "pdf": b"%PDF", "svg": b"<?xml"}
    assert (tmp_path / name).read_bytes().startswith(starts[name[-3:]])
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([name, "toys.py"])


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--episdes", "3"], "--episdes"),
        (["--episodes", "x"], "'x'"),
        (["--episodes"], "--episodes"),
        (["--episodes", "0"], "--episodes must be an integer .* got 0"),
        (["--learning-rate", "1.5"], r"--learning-rate must lie in \[0, 1\], got 1.5"),
        (["--discount", "nan"], r"--discount must lie in \[0, 1\], got nan"),
        (["--min-epsilon", "0.9"], "--min-epsilon must lie in .* got 0.9"),
        (["--seed", "1.5"], "--seed.*1.5"),
        (["--seed", "-1"], "--seed must be .* got -1"),
        (["--backend", "fortran"], "'fortran'"),
        (["--preset", "novel"], "--preset must be one of 'article', 'solved' for MountainCar-v0, got 'novel'$"),
        (["NoSuchCar-v0"], "NoSuchCar"),
        (["MountainCar-v0", "Taxi-v4"], "Taxi-v4"),
        (["MountainCar-v0", "--actions", "3"], "actions applies to Box action spaces only"),
        (["Pendulum-v1", "--actions", "all"], "a count or the actions themselves, got 'all'"),
        (["--discretizer", "edges", "--edges", "0", "1"], r"a row such as \[-0.5,0,0.5\]"),
        (["--env-kwargs", "goal_velocity"], "'goal_velocity' has no value"),
        (["--initial-q", "1", "2", "3"], "LOW HIGH, VALUE or FILE"),
        (["--initial-q", "none.npz"], "none.npz"),
        (["--config", "none.toml"], "none.toml"),
        (["--plot", "rewards.xyz"], r"plot must end in one of .*\.png.* got 'rewards.xyz'"),
        (["--plot", "none/rewards.png"], "plot must be a file that can be written, got 'none/rewards.png'"),
        (["--save", "none/run.npz"], "save must be a file that can be written, got 'none/run.npz'"),
        (["--save", "."], r"save must be a file, got the folder '\.'"),
        (["--record", "toys.py"], "record must be a folder .* got 'toys.py'"),
        (["--watch", "0"], "watch must be an integer of at least 1, got 0"),
    ],
)
def test_bad_usage_is_one_line_and_exit_code_2(tmp_path: Path, arguments: list[str], said: str) -> None:
    line = refused("train", *arguments, cwd=tmp_path)
    assert line.startswith("qtab train: error: ")
    assert re.search(said, line), line


def test_bad_usage_ends_the_process_with_exit_code_2(tmp_path: Path) -> None:
    assert "episodes must be" in refused("train", "--episodes", "0", cwd=tmp_path, run=qtab)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("epsiodes = 3", "run.toml: unknown setting 'epsiodes' (did you mean 'episodes'?)"),
        ("episodes =", "must be a TOML file, got 'run.toml'"),
    ],
)
def test_a_bad_config_file_is_refused_with_the_reason(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "run.toml").write_text(text)
    assert said in refused("train", "--config", "run.toml", cwd=tmp_path)


def test_an_unknown_command_is_refused_with_the_known_ones(tmp_path: Path) -> None:
    assert "unknown command 'fly'; use train, resume, verify, explain, diagnose" in refused("fly", cwd=tmp_path)
    assert "'trian' (did you mean 'train'?)" in refused("trian", cwd=tmp_path)


def test_version_and_help(tmp_path: Path) -> None:
    assert qtab_here("--version", cwd=tmp_path).stdout == f"qtab {importlib.metadata.version('qtab')}\n"
    assert "verify" in qtab_here("--help", cwd=tmp_path).stdout
    assert qtab_here(cwd=tmp_path).returncode == 2


@pytest.mark.slow
def test_a_failing_environment_saves_the_run_and_prints_one_line(tmp_path: Path) -> None:
    done = qtab(
        *("train", "toys:Walk-v0", "--scale", "1", "--episodes", "5000", "--env-kwargs", "fail_after", "2000"),
        *("--save", "part.npz"),
        cwd=tmp_path,
    )
    assert done.returncode == 1
    assert done.stderr == "qtab train: error: the motor is broken\n"
    run = package.load(tmp_path / "part.npz")
    assert not run.completed
    assert 0 < run.episode_lengths.sum() <= 2000


def test_the_command_needs_no_library_but_those_of_the_package(tmp_path: Path) -> None:
    for name in ("tqdm", "matplotlib", "scipy", "pandas", "shtab"):
        (tmp_path / f"{name}.py").write_text(f"raise ModuleNotFoundError(\"No module named '{name}'\", name='{name}')")
    done = qtab("train", "--episodes", "5", "--save", "run.npz", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    refused = qtab("train", "--plot", "curve.png", cwd=tmp_path)
    assert refused.returncode == 2
    assert "this needs matplotlib, which is not installed; run: pip install 'matplotlib" in refused.stderr


def heed_ctrl_c() -> None:
    """Background jobs of a shell ignore Ctrl-C, and so would their children."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@pytest.mark.slow
@posix_only
def test_ctrl_c_saves_and_plots_what_was_learned_so_far(tmp_path: Path) -> None:
    process = subprocess.Popen(
        [*QTAB, "train", "--episodes", "1000000", "--seed", "0", "--save", "part.npz", "--plot", "part.png"],
        cwd=tmp_path,
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=heed_ctrl_c,
    )
    assert process.stdout is not None
    assert process.stdout.readline().startswith("MountainCar-v0 in Rust")
    first = process.stdout.readline()
    assert first.startswith("Episode 10000 ")
    process.send_signal(signal.SIGINT)
    out, err = process.communicate()
    out = first + out
    assert process.returncode == 130
    assert err == ""
    run = package.load(tmp_path / "part.npz")
    finished = len(run.episode_returns)
    assert not run.completed
    assert 10_000 <= finished < 1_000_000
    assert f"Stopped after {finished:,} of 1,000,000 episodes" in out
    assert f"Episode {finished // 10_000 * 10_000} Average Reward" in out
    assert out.endswith("Saved the run to part.npz\nSaved the plot to part.png\n")
    assert (tmp_path / "part.png").read_bytes().startswith(b"\x89PNG")
    # The first episodes follow the schedule of the full run.
    again = package.train(
        "MountainCar-v0",
        episodes=1_000_000,
        seed=0,
        callback=lambda progress: progress.episodes < 100,
    )
    assert np.array_equal(run.episode_returns[:100], again.episode_returns)


def test_verify_reports_equality_and_exits_with_0(tmp_path: Path) -> None:
    package.train("MountainCar-v0", seed=0, episodes=12).save(tmp_path / "run.npz")
    for arguments, count in ((["run.npz"], 12), (["run.npz", "--episodes", "5"], 5)):
        done = qtab_here("verify", *arguments, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert f"seed 0, {count} episodes against Gymnasium and NumPy" in done.stdout
        assert done.stdout.count(" equal\n") == 3


def test_verify_exits_with_1_for_a_changed_table(tmp_path: Path) -> None:
    run = package.train("MountainCar-v0", seed=0, episodes=10)
    run.tables[0, 0, 0] += 1e-12
    run.save(tmp_path / "run.npz")
    done = qtab_here("verify", "run.npz", cwd=tmp_path)
    assert done.returncode == 1
    assert "Q table  DIFFERENT" in done.stdout
    assert done.stderr == ""


def test_verify_refuses_files_that_are_not_runs(tmp_path: Path) -> None:
    (tmp_path / "bad.npz").write_bytes(b"not a run")
    assert "'bad.npz' is not a run file" in refused("verify", "bad.npz", cwd=tmp_path)
    assert "none.npz" in refused("verify", "none.npz", cwd=tmp_path)
    package.train("MountainCar-v0", seed=0, episodes=5).save(tmp_path / "run.npz")
    assert "episodes must be" in refused("verify", "run.npz", "--episodes", "6", cwd=tmp_path)
