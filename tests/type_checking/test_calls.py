"""Type checkers accept right calls of the public functions, and refuse wrong ones.

Here pyright reads the calls. mypy reads them with everything else in ``.ci/run lint``, which in its strict mode also
reports an ignored error that it does not find.
"""

import subprocess
import sys
from pathlib import Path

import pytest

from support.repository import ROOT

FOLDER = Path(__file__).parent


@pytest.mark.slow
def test_pyright_reports_exactly_the_wrong_calls() -> None:
    command = [sys.executable, "-m", "pyright", "--project", str(FOLDER), "--pythonpath", sys.executable]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "0 errors, 0 warnings" in done.stdout


def test_mypy_reads_the_calls_with_everything_else() -> None:
    settings = (ROOT / "pyproject.toml").read_text(encoding="utf-8").partition("[tool.mypy]\n")[2].partition("\n[[")[0]
    assert "strict = true" in settings
    assert 'files = ["python/qtab", "benchmarks", "tests"]' in settings
    assert "\n    .venv/$bin/mypy\n" in (ROOT / ".ci/run").read_text(encoding="utf-8")
