"""``qtab exercises`` as a teacher runs it."""

from pathlib import Path

from qtab.exercises import EXERCISES
from support.processes.command import qtab_here


def test_it_lists_the_exercises_and_shows_a_task(tmp_path: Path) -> None:
    listed = qtab_here("exercises", cwd=tmp_path).stdout.splitlines()
    assert [line.split()[1] for line in listed] == list(EXERCISES)
    assert qtab_here("exercises", "2", cwd=tmp_path).stdout.rstrip() == EXERCISES["sample_average"].starter.rstrip()


def test_it_hands_out_and_grades(tmp_path: Path) -> None:
    folder = tmp_path / "submissions"
    folder.mkdir()
    done = qtab_here("exercises", "sample_average,1", "--out", "submissions/ada.ipynb", cwd=tmp_path)
    assert done.stdout == f"Saved the tasks to {Path('submissions/ada.ipynb')}\n", done.stderr
    grading = ("--grade", "submissions", "--save", "marks.csv", "--reports", "reports")
    done = qtab_here("exercises", "sample_average,1", *grading, cwd=tmp_path)
    assert done.stdout.splitlines()[:2] == [
        "student  sample_average  epsilon_greedy  sum",
        "ada      0 of 2          0 of 4          0 of 6",
    ], done.stderr
    assert done.stderr == ""
    assert (tmp_path / "marks.csv").read_text(encoding="utf-8").endswith("\nada,0,0,0\n")
    assert "2 checks passed" in (tmp_path / "reports" / "ada.txt").read_text(encoding="utf-8")


def test_reports_that_cannot_be_written_are_refused_before_grading(tmp_path: Path) -> None:
    (tmp_path / "submissions").mkdir()
    (tmp_path / "submissions" / "ada.py").write_text("", encoding="utf-8")
    (tmp_path / "reports").write_text("a file", encoding="utf-8")
    done = qtab_here("exercises", "1", "--grade", "submissions", "--reports", "reports", cwd=tmp_path)
    assert done.returncode == 2
    assert "--reports must be a folder that can be written, got 'reports': File exists" in done.stderr
    assert done.stdout == ""
