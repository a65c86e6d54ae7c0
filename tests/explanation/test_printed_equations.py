"""Every equation that ``explain`` prints is true: in symbols with the exact numbers, and as printed."""

import itertools
import math
import re
from typing import Any

import gymnasium as gym
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import qtab
from qtab.config.choices import CHOICES
from qtab.config.options import AVERAGE_REWARD, ONE_STEP, PREFERENCES, TABLES_ONLY
from qtab.explanation.equations import bootstrap_symbol, gain
from qtab.explanation.policy_update import PolicyUpdate
from qtab.explanation.records import Choice, ExplainedStep, Update
from support.environments.masked import MASKS, MaskedGraph
from support.learners.learner_settings import run_settings
from support.learners.printed_equations import NotNumericError, check_equations, check_symbols, evaluated, printed

ALGORITHMS = CHOICES["algorithm"]
EXAMPLES = max(1, (settings.default or settings()).max_examples // 10)
LAKE: dict[str, Any] = {"env": "FrozenLake-v1", "max_episode_steps": 9, "episodes": 30, "seed": 3, "initial_q": 0.5}
HASHED: dict[str, Any] = {"discretizer": "tiles", "tilings": 4, "tiles": (5, 4), "hashed_rows": 3}
CAR: dict[str, Any] = {"env": "MountainCar-v0", "max_episode_steps": 15, "episodes": 8, "seed": 1}


def check(explanation: qtab.Explanation) -> int:
    """Evaluates all equations of all steps, and what is printed of them; returns the number of the printed ones."""
    expected = 0
    for step in explanation.steps:
        for update in (*step.updates, *step.planning):
            check_update(update, explanation.config)
        for change in step.policy_updates:
            check_policy_update(change, explanation.config)
        shown = [update.numbers for update in step.updates] + [change.numbers for change in step.policy_updates]
        expected += sum(check_equations(line) for line in itertools.chain.from_iterable(shown))
        check_reward(step)
    found = check_equations(str(explanation))
    assert found >= expected
    return found


def check_update(update: Update, config: qtab.Config) -> None:
    following = math.nan if update.bootstrap is None else update.bootstrap
    discounted = [reward * config.discount**k for k, reward in enumerate(update.rewards)]
    names = {
        "γ": config.discount,
        "R": update.rewards[0],
        "(R + κ √τ)": update.rewards[0],
        **{f"R{index + 1}": reward for index, reward in enumerate(update.rewards)},
        "Σ γ^(k-1) Rk": math.fsum(discounted),
        bootstrap_symbol(config.algorithm, update.table): following,
        "target": update.target,
        **dict.fromkeys(("Q(S, A)", "Q1(S, A)", "Q2(S, A)"), update.before),
    }
    if update.average_reward is not None:
        names |= {"R̄": update.average_reward, "β": config.reward_learning_rate or 0.0}
    if update.step_sizes:
        names["α"] = alpha = gain(update.rows, update.step_sizes, ())
        if update.traces:
            names["z"] = math.nan if alpha == 0.0 else gain(update.rows, update.step_sizes, update.traces) / alpha
        if update.old_value is not None:
            names["Q_old"] = update.old_value
    results = [update.target, update.after]
    if update.average_reward is not None:
        results.insert(1, update.average_reward + (config.reward_learning_rate or 0.0) * update.error)
    for equation, numbers, result in zip(update.equations, update.numbers, results, strict=True):
        if not (update.traces and names["α"] == 0.0):
            check_symbols(equation, names, result)
        check_result(numbers, result)
    assert update.error == update.target - update.before


def check_policy_update(change: PolicyUpdate, config: qtab.Config) -> None:
    """The step size is of each active row; a row that is active twice has two steps, but one trace."""
    preference = sum(row[change.action] for row in change.before)
    after = sum(row[change.action] for row in change.after)
    if change.traces:
        alpha, z = change.step_size * len(change.rows), sum(row[change.action] for row in change.traces)
        z /= len(change.rows)
    else:
        alpha, z = change.step_size * sum(map(change.rows.count, change.rows)), math.nan
    names = {
        **{"γ": config.discount, "R": change.reward or 0.0, "R̄": change.reference, "v(S)": change.reference},
        **{"v(S')": math.nan if change.bootstrap is None else change.bootstrap, "G": change.target},
        **{"δ": change.error, "α": alpha, "∇ ln π(A | S)": change.gradient[change.action], "z": z},
        "H(S, A)": preference,
    }
    results = [change.error, after][-len(change.equations) :]
    for equation, numbers, result in zip(change.equations, change.numbers, results, strict=True):
        check_symbols(equation, names, result)
        check_result(numbers, result)


def check_result(numbers: str, result: float) -> None:
    """The last number of a line is its result."""
    last = numbers.replace("<-", "=").rpartition(" = ")[2]
    try:
        assert evaluated(last).low <= result <= evaluated(last).high, numbers
    except NotNumericError as error:
        raise AssertionError(numbers) from error


def check_reward(step: ExplainedStep) -> None:
    """R in the equations is the reward with its bonus, as the line of the reward says."""
    R = step.reward + step.bonus  # noqa: N806 - the book's name
    own = [update.rewards[0] for update in step.updates if update.step == step.step]
    own += [change.reward for change in step.policy_updates if change.reward is not None]
    assert set(own) <= {R}
    assert (f"R = {step.reward:.6g} + " in step.reward_text) == (step.bonus != 0.0)


def options(algorithm: str) -> dict[str, Any]:
    """Settings with which an algorithm has long sums, several planned updates and traces."""
    if algorithm.startswith("n_step"):
        return {"n_steps": 6}
    return {"planning_steps": 3} if algorithm in ("dyna_q", "dyna_q_plus", "prioritized_sweeping") else {}


def explained(run: qtab.Run, **given: Any) -> int:
    episodes = sorted({0, 1, len(run.episode_returns) - 1})
    return sum(check(qtab.explain(run, episode, steps=10_000, **given)) for episode in episodes)


def bandit(algorithm: str, chosen: dict[str, Any]) -> dict[str, Any]:
    if algorithm == "gradient_bandit":  # it learns from the next reward alone
        return {**chosen, "env": "qtab/KArmedBandit-v0", "max_episode_steps": 1, "initial_q": 0.0}
    return chosen


@pytest.mark.parametrize("count_bonus", [0.0, 0.5])
@pytest.mark.parametrize("on_truncation", ["bootstrap", "terminate"])
@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_every_equation_is_true(algorithm: Any, on_truncation: Any, count_bonus: float) -> None:
    chosen = bandit(algorithm, LAKE) | options(algorithm)
    if on_truncation == "terminate" and "reinforce" not in algorithm:
        chosen["on_truncation"] = on_truncation
    assert explained(qtab.train(algorithm=algorithm, count_bonus=count_bonus, **chosen)) > 0


@pytest.mark.parametrize("algorithm", [name for name in ALGORITHMS if name not in (*TABLES_ONLY, "gradient_bandit")])
def test_equations_of_tiles_that_share_rows_are_true(algorithm: Any) -> None:
    run = qtab.train(algorithm=algorithm, count_bonus=0.5, **CAR, **HASHED)
    explained(run)
    steps = qtab.explain(run, 3, steps=100).steps
    assert any(len(set(step.rows)) < len(step.rows) for step in steps)


@pytest.mark.parametrize("kind", ["accumulating", "replacing", "clearing"])
@pytest.mark.parametrize("algorithm", ["sarsa_lambda", "watkins_q_lambda"])
def test_equations_of_every_kind_of_traces_are_true(algorithm: Any, kind: Any) -> None:
    explained(qtab.train(algorithm=algorithm, traces=kind, **CAR, **HASHED))
    explained(qtab.train(algorithm=algorithm, traces=kind, learning_rate_schedule="visits", **LAKE))


@pytest.mark.parametrize("algorithm", [name for name in ALGORITHMS if name not in (*PREFERENCES, *AVERAGE_REWARD)])
def test_equations_of_steps_with_rows_of_their_own_are_true(algorithm: Any) -> None:
    explained(qtab.train(algorithm=algorithm, time_aware=True, **LAKE | options(algorithm)))


@pytest.mark.parametrize("algorithm", ONE_STEP)
def test_equations_of_assigned_values_are_true(algorithm: Any) -> None:
    run = qtab.train(
        algorithm=algorithm, terminal_update="assign", count_bonus=0.5, **LAKE | {"initial_q": 0.1, "episodes": 10}
    )
    explained(run)
    steps = [step for episode in range(10) for step in qtab.explain(run, episode, steps=100).steps]
    assert any(update.assigned for step in steps for update in (*step.updates, *step.planning))


@pytest.mark.parametrize("algorithm", [name for name in ALGORITHMS if name != "gradient_bandit"])
def test_equations_of_masked_actions_are_true(algorithm: Any) -> None:
    settings: dict[str, Any] = {"episodes": 6, "max_episode_steps": 8, "seed": 0, "action_mask": True}
    run = qtab.train(MaskedGraph(MASKS), algorithm=algorithm, **settings | options(algorithm))
    explained(run, env=gym.wrappers.TimeLimit(MaskedGraph(MASKS), 8))


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_equations_of_a_resumed_run_are_true(algorithm: Any) -> None:
    chosen = bandit(algorithm, LAKE)
    part = qtab.train(
        algorithm=algorithm, callback=lambda progress: progress.episodes < 11, callback_every=11, **chosen
    )
    assert not part.completed
    explained(qtab.resume(part))


@pytest.mark.parametrize("algorithm", ALGORITHMS)
def test_equations_of_random_settings_are_true(algorithm: Any) -> None:
    @settings(max_examples=EXAMPLES, deadline=None)
    @given(run_settings(algorithm), st.sampled_from([0.0, 0.3]))
    def evaluate(chosen: dict[str, Any], count_bonus: float) -> None:
        try:
            run = qtab.train("MountainCar-v0", count_bonus=count_bonus, **chosen)
        except OverflowError:
            return
        explained(run)

    evaluate()


def test_upper_bounds_are_true() -> None:
    run = qtab.train(exploration="ucb", confidence=0.7, **LAKE)
    counts: dict[int, list[int]] = {}
    for episode in range(6):
        for step in qtab.explain(run, episode, steps=100).steps:
            times = counts.setdefault(step.rows[0], [0] * 4)
            N, Q = times[step.choice.action], step.updates[0].before  # noqa: N806 - the book's names
            bound = Q + 0.7 * math.sqrt(math.log(1 + sum(times)) / N) if N else math.inf
            assert f"Q + c √(ln t / N) = {bound:.6g} is the largest" in str(step.choice)
            times[step.choice.action] += 1
    assert max(map(max, counts.values())) > 1


@pytest.mark.parametrize(("drawn", "sign"), [(0.79996, "<"), (0.8000001, ">="), (0.1, "<"), (0.97, ">=")])
def test_compared_numbers_are_printed_so_that_they_differ(drawn: float, sign: str) -> None:
    reason: Any = "greedy" if sign == "<" else "explored"
    text = str(Choice(0, reason, (0.0,), 1.0, drawn, 1, 0.2, None, random_ties=False))
    (one, found, other) = re.findall(r"([\d.]+) (<|>=) 1 - epsilon = ([\d.]+)", text)[0]
    assert (found, float(other)) == (sign, 0.8)
    assert float(one) < float(other) if sign == "<" else float(one) >= float(other)


def test_a_false_equation_is_found() -> None:
    assert check_equations("update  H(S, A) <- 1.70917 + 0.2 · (-9.98203) · 0.515594 = 0.679835") == 1
    with pytest.raises(AssertionError, match="the sides differ"):
        check_equations("update  H(S, A) <- 1.70917 + 0.2 · (-9.98203) · 0.515594 = 0.165163")
    with pytest.raises(AssertionError, match="the sides differ"):
        check_equations("target = -1 + 0.9^2 · (-2) = -2.62003")
    assert check_equations("ε = 0.5; α = 0.1, γ = 0.9") == 0
    assert evaluated("2 · [1 - (-0.5)]").meets(printed("3"))
