"""Twelve exercises in reinforcement learning, and a grader that compares a solution with the reference to the last bit.

    import qtab

    print(qtab.exercises.find("sarsa").starter)  # the task, and the code to start from
    qtab.exercises.check("sarsa", sarsa)  # shows where your function and the reference part
    qtab.exercises.check("sarsa", sarsa).assert_passed()  # in pytest
    qtab.exercises.hand_out(["epsilon_greedy", "sarsa"], "homework.ipynb")  # for a class
    print(qtab.exercises.grade("submissions", ["epsilon_greedy", "sarsa"]))

A solution is plain Python with NumPy and Gymnasium. Each exercise is a module in :mod:`qtab.exercises.definitions`.
"""

from qtab.exercises.classroom.grading import grade
from qtab.exercises.classroom.handing_out import hand_out
from qtab.exercises.classroom.marks import Mark, Marks
from qtab.exercises.collection import EXERCISES, find
from qtab.exercises.exercise import Exercise
from qtab.exercises.function_check import FunctionCheck
from qtab.exercises.grader import check
from qtab.exercises.learner_check import LearnerCheck
from qtab.exercises.record import Difference
from qtab.exercises.report import CheckResult, Report

__all__ = [
    "EXERCISES",
    "CheckResult",
    "Difference",
    "Exercise",
    "FunctionCheck",
    "LearnerCheck",
    "Mark",
    "Marks",
    "Report",
    "check",
    "find",
    "grade",
    "hand_out",
]


def __dir__() -> list[str]:
    return [*__all__, *(name for name in globals() if name.startswith("__"))]
