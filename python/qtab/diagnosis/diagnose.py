"""``qtab.diagnose``: looks for reasons why a run did not solve its environment."""

import time
from collections.abc import Iterable
from dataclasses import replace

import gymnasium as gym
import numpy as np

from qtab._utils import checks
from qtab.config.options import PREFERENCES
from qtab.diagnosis.checks import CHECKS, Check
from qtab.diagnosis.diagnosis import Diagnosis
from qtab.diagnosis.facts import Facts
from qtab.diagnosis.finding import Finding, Unchecked
from qtab.planning.optimum import Optimum
from qtab.results.run import Run
from qtab.training.setup.run_env import check_same


def diagnose(
    run: Run, optimum: Optimum | None = None, seeds: int | None = None, *, env: gym.Env | None = None
) -> Diagnosis:
    """Looks for reasons why a run did not solve its environment, and for changes to try.

    Each finding is computed from the run and from its environment: some checks repeat the run in Rust, and train other
    seeds. A run that solved its environment has no findings, except for settings that are mistakes.

    Args:
        run: The run.
        optimum: The result of :func:`qtab.optimum` for the run, or for the table that :func:`qtab.tabulate` made of its
            environment. None computes the optimum of small tables, and uses the best known return of MountainCar-v0.
        seeds: The number of other seeds to train for comparison; None trains for a fraction of a second.
        env: The environment of the run, for one without an id or that qtab cannot make again. Episodes of the greedy
            policy are played in it; it is reset and stepped, and not closed. None makes the environment of the run.

    Returns:
        The findings; they print as text. Its ``what_if()`` tries the changes that they advise.

    Raises:
        MemoryError: if the runs of so many ``seeds`` would take more than half of the machine's memory.
        TypeError: for an argument of the wrong type.
        ValueError: for a run without a finished episode or with weighted features, such as those of a Fourier basis, or
            the optimum of another environment, or if ``env`` differs from the environment of the run.
    """
    checks.instance("run", run, Run)
    if run.discretizer.is_weighted:
        raise ValueError(
            f"run must have rows for its observations to be diagnosed, got weighted features: {run.discretizer!r}"
        )
    if optimum is not None:
        checks.instance("optimum", optimum, Optimum)
        optimum.check_same_env(run)
    if seeds is not None:
        seeds = checks.integer("seeds", seeds, least=0)
    if env is not None:
        checks.instance("env", env, gym.Env)
        check_same(run, env)
    if len(run.episode_returns) == 0:
        raise ValueError("run must have a finished episode, got one that was stopped during its first")
    began = time.perf_counter()
    facts = Facts(run, optimum, seeds, env)
    findings: list[Finding] = []
    unremarkable: list[str] = []
    not_made: dict[str, str] = {}
    with np.errstate(all="ignore"):  # values that diverged
        for name, check in CHECKS.items():
            if facts.solved and not check.if_solved:
                continue
            found = _unchecked(check, facts, findings) or check.find(facts)
            if found is None:
                unremarkable.append(name)
            elif isinstance(found, Unchecked):
                not_made[name] = found.reason
            else:
                findings.append(replace(found, name=name))
    return Diagnosis(
        run=run,
        solved=facts.solved,
        findings=tuple(findings),
        unremarkable=tuple(unremarkable),
        not_made=tuple(not_made),
        reasons=not_made,
        facts=facts,
        seconds=time.perf_counter() - began,
    )


def _unchecked(check: Check, facts: Facts, findings: Iterable[Finding]) -> Unchecked | None:
    """Returns the reason why a check cannot be made; None if it can."""
    if any(finding.name == "divergence" for finding in findings):
        return Unchecked("the values diverged")  # the other checks would misread such values
    if check.reads_values and facts.config.algorithm in PREFERENCES:
        return Unchecked("it learned preferences instead of action values")
    if check.repeats and not facts.can_repeat:
        return Unchecked(facts.why_not_repeated)
    return None
