"""Type checkers accept right calls of the public functions, and refuse wrong ones."""

import subprocess
import sys
from pathlib import Path

import pytest

from support.repository import ROOT

FOLDER = Path(__file__).parent
CHECKERS = {
    "mypy": ["mypy", "--config-file", str(FOLDER / "mypy.ini"), str(FOLDER / "calls.py")],
    "pyright": ["pyright", "--project", str(FOLDER), "--pythonpath", sys.executable],
}


@pytest.mark.slow
@pytest.mark.parametrize("checker", CHECKERS)
def test_a_type_checker_reports_exactly_the_wrong_calls(checker: str) -> None:
    command = [sys.executable, "-m", *CHECKERS[checker]]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "no issues" in done.stdout or "0 errors, 0 warnings" in done.stdout
