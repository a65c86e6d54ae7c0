"""The workflows: what they call exists, what they use is pinned, and they may do no more than they need.

`.ci/run lint` checks them with zizmor and with the schema of workflows.
"""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from support.repository import ROOT

FOLDER = ROOT / ".github"
WORKFLOWS = sorted((FOLDER / "workflows").glob("*.yml"))
FILES = [*WORKFLOWS, *sorted((FOLDER / "actions").glob("*/action.yml"))]
pytestmark = pytest.mark.skipif(not FOLDER.exists(), reason="needs the workflows of the repository")


def tasks() -> set[str]:
    """The functions of `.ci/run` and of what it sources."""
    scripts = [ROOT / ".ci" / "run", *sorted((ROOT / ".ci").glob("*.sh"))]
    return {
        name for script in scripts for name in re.findall(r"^(\w+)\(\) \{$", script.read_text("utf-8"), re.MULTILINE)
    }


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.stem)
def test_a_workflow_calls_tasks_that_exist(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    called = {task for line in re.findall(r"\.ci/run ([\w ]+)", text) for task in line.split()}
    called |= set(re.findall(r"- task: (\w+)", text))
    assert called
    assert called <= tasks()


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.relative_to(FOLDER).as_posix())
def test_actions_are_pinned_by_hash_with_their_version(path: Path) -> None:
    used = re.findall(r"uses: (.+)", path.read_text(encoding="utf-8"))
    assert used
    for action in used:
        assert re.fullmatch(r"\$/\.github/actions/\w+|[\w-]+/[\w-]+@[0-9a-f]{40} # v\d+\.\d+\.\d+", action), action


def test_an_action_has_the_same_version_everywhere() -> None:
    pinned = {use for path in FILES for use in re.findall(r"uses: ([\w-]+/[\w-]+@\S+ # \S+)", path.read_text("utf-8"))}
    assert len({use.partition("@")[0] for use in pinned}) == len(pinned)


@pytest.mark.parametrize("path", WORKFLOWS, ids=lambda path: path.stem)
def test_jobs_have_time_limits_and_permissions_of_their_own_and_keep_no_credentials(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert "\npermissions: {}\n" in text
    assert "\nconcurrency:\n" in text
    jobs = re.split(r"\n  (?=[\w-]+:\n)", text.partition("\njobs:\n")[2])
    for job in jobs:
        assert "    timeout-minutes: " in job, job
        assert "    permissions:" in job, job
        assert job.count("actions/checkout@") == job.count("persist-credentials: false"), job


def test_only_the_job_that_publishes_can_sign_for_pypi() -> None:
    release = (FOLDER / "workflows" / "release.yml").read_text(encoding="utf-8")
    before, _, publish = release.partition("\n  publish:\n")
    assert "id-token: write" not in before
    assert "environment: pypi" in publish
    assert ".ci/run" not in publish


NAMES = ("Cargo.toml", "Cargo.lock", "CITATION.cff")


def versioned(folder: Path, tag: str, changelog: str) -> subprocess.CompletedProcess[str]:
    """The result of `.ci/version.py` in a copy of the files that it changes."""
    (folder / ".ci").mkdir()
    for name in (*NAMES, ".ci/version.py"):
        (folder / name).write_bytes((ROOT / name).read_bytes())
    (folder / "CHANGELOG.md").write_text(f"# Changelog\n\n{changelog}\n", encoding="utf-8")
    command = [sys.executable, ".ci/version.py", tag]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


@pytest.mark.parametrize(
    ("tag", "heading", "version"),
    [("v3.4.5", "## [3.4.5] - 2031-01-02", "3.4.5"), ("v3.4.5-rc.1", "## [3.4.5] - unreleased", "3.4.5-rc.1")],
)
def test_the_version_of_a_tag_is_written_wherever_it_stands(
    tmp_path: Path, tag: str, heading: str, version: str
) -> None:
    assert versioned(tmp_path, tag, heading).returncode == 0
    crates = len(re.findall(r'^name = "qtab-', (ROOT / "Cargo.lock").read_text(encoding="utf-8"), re.MULTILINE))
    for name, places in zip(NAMES, (2, crates, 1), strict=True):
        assert (tmp_path / name).read_text(encoding="utf-8").count(version) == places


@pytest.mark.parametrize(
    ("tag", "heading", "error"),
    [
        ("3.4.5", "## [3.4.5] - 2031-01-02", "the tag must be like v1.2.3"),
        ("v3.4.5; true", "## [3.4.5] - 2031-01-02", "the tag must be like v1.2.3"),
        ("v3.4.5", "## [3.4.5] - unreleased", "CHANGELOG.md needs a heading '## [3.4.5] - YYYY-MM-DD'"),
        ("v3.4.5", "## [3.4.4] - 2031-01-02", "CHANGELOG.md needs a heading '## [3.4.5] - YYYY-MM-DD'"),
    ],
)
def test_a_tag_without_a_version_or_without_a_section_of_the_changelog_is_refused(
    tmp_path: Path, tag: str, heading: str, error: str
) -> None:
    done = versioned(tmp_path, tag, heading)
    assert done.returncode == 1
    assert error in done.stderr
    assert (tmp_path / "Cargo.lock").read_bytes() == (ROOT / "Cargo.lock").read_bytes()


def test_the_links_of_the_readme_become_absolute_and_the_crates_know_their_repository(tmp_path: Path) -> None:
    (tmp_path / ".ci").mkdir()
    for name in ("links.py", "launch.py"):
        (tmp_path / ".ci" / name).write_bytes((ROOT / ".ci" / name).read_bytes())
    (tmp_path / "README.md").write_bytes((ROOT / "README.md").read_bytes())
    manifests = [Path("rust") / crate / "Cargo.toml" for crate in ("core", "env")]
    for manifest in manifests:
        (tmp_path / manifest).parent.mkdir(parents=True)
        (tmp_path / manifest).write_bytes((ROOT / manifest).read_bytes())
    address = "https://github.com/someone/qtab"
    command = [sys.executable, ".ci/links.py", address, "v3.4.5"]
    assert subprocess.run(command, cwd=tmp_path, capture_output=True, check=False).returncode == 0
    text = (tmp_path / "README.md").read_text(encoding="utf-8")
    assert f"]({address}/raw/v3.4.5/docs/pictures/first_picture.png)" in text
    assert f"]({address}/blob/v3.4.5/docs/tutorial/index.md)" in text
    assert re.findall(r"\]\((?!https://)[^)]*\)", text) == []
    notebook = "examples/study.ipynb"
    assert f"]({address}/blob/v3.4.5/{notebook}) [Colab](https://colab.research.google.com/github/someone/" in text
    assert "[Binder](https://mybinder.org/v2/gh/someone/qtab/v3.4.5?labpath=examples%2Fstudy.ipynb)" in text
    for manifest in manifests:
        assert (tmp_path / manifest).read_text(encoding="utf-8").count(f'\nrepository = "{address}"\n') == 1
    refused = subprocess.run(
        [*command[:2], "x; y", "v3.4.5"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert "the repository must be like" in refused.stderr


def test_the_scripts_find_programs_where_windows_has_them_too() -> None:
    for path in sorted((ROOT / ".ci").iterdir()):
        if path.suffix in ("", ".sh"):
            text = path.read_text(encoding="utf-8").replace("${line//.venv\\/bin\\//.venv/$bin/}", "")
            assert not re.findall(r"venv\S*/bin\b", text), path.name


def test_the_scripts_name_no_version_of_rust_of_their_own() -> None:
    manifest = (ROOT / "Cargo.toml").read_text(encoding="utf-8")
    (lowest,) = re.findall(r'^rust-version = "(.+)"', manifest, re.MULTILINE)
    assert f"The minimum supported version is {lowest}." in (ROOT / "rust/core/README.md").read_text(encoding="utf-8")
    texts = [path.read_text(encoding="utf-8") for path in (ROOT / ".ci").iterdir() if path.is_file()]
    assert not [text for text in texts if re.search(r"\b1\.(8[89]|9\d)\b", text)]
    workflow = (ROOT / ".github" / "workflows" / "ci.yml").read_text(encoding="utf-8")
    for rust in re.findall(r'^\s*rust: "([\d.]+)"', workflow, re.MULTILINE):
        assert rust.startswith(f"{lowest}.")
