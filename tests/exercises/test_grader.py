"""The grader passes solutions that are right, and explains why others fail."""

import re
from functools import partial

import numpy as np
import pytest

import qtab
from qtab.exercises import EXERCISES, check, definitions, find
from qtab.exercises.mistakes import MISTAKES
from qtab.exercises.record import Event, Misuse, Record, first_difference

SARSA = find("sarsa").model
NAMES = sorted(EXERCISES)


def epsilon_greedy(values, epsilon, rng):
    return np.argmax(values) if rng.random() < 1 - epsilon else rng.integers(len(values))


def book_sarsa(env, q, episodes, learning_rate, discount, epsilon, rng):
    """As many students write it: an action in every next state, and no value after the end."""
    for _ in range(episodes):
        state, _ = env.reset()
        action, done = epsilon_greedy(q[state], epsilon, rng), False
        while not done:
            next_state, reward, terminated, truncated, _ = env.step(action)
            done = terminated or truncated
            next_action = epsilon_greedy(q[next_state], epsilon, rng)
            target = reward + discount * q[next_state, next_action] * (not done)
            q[state, action] += learning_rate * (target - q[state, action])
            state, action = next_state, next_action


@pytest.mark.parametrize("name", NAMES)
def test_the_reference_passes(name: str) -> None:
    report = check(name, EXERCISES[name].model)
    assert report.passed
    assert report.mistakes == report.advice == ()
    report.assert_passed()
    assert f"all {len(report.results)} checks passed" in repr(report)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_each_mistake_fails_and_is_recognised(name: str) -> None:
    exercise = EXERCISES[name]
    for key in exercise.mistakes:
        report = check(name, partial(exercise.model, wrong=frozenset([key])))
        assert not report.passed, key
        assert report.mistakes == (MISTAKES[key],), key
        assert any(result.difference is not None for result in report.results), key


def test_every_mistake_belongs_to_an_exercise() -> None:
    assert MISTAKES.keys() == {key for exercise in EXERCISES.values() for key in exercise.mistakes}


def test_two_mistakes_at_once_are_recognised() -> None:
    report = check("sarsa", book_sarsa)
    assert not report.passed
    assert set(report.mistakes) == {MISTAKES["truncation"], MISTAKES["draws_at_end"]}
    assert not report.recognition.alternatives
    assert "these 2 mistakes" in str(report)


def test_q_learning_handed_in_as_sarsa_is_recognised() -> None:
    report = check("sarsa", find("q_learning").model)
    assert report.mistakes == (MISTAKES["q_learning"],)


def test_a_state_that_never_changes_is_recognised() -> None:
    def forgetful(env, q, episodes, learning_rate, discount, epsilon, rng):
        for _ in range(episodes):
            state, _ = env.reset()
            over = False
            while not over:
                action = epsilon_greedy(q[state], epsilon, rng)
                next_state, reward, terminated, truncated, _ = env.step(action)
                target = reward if terminated else reward + discount * q[next_state].max()
                q[state, action] += learning_rate * (target - q[state, action])
                over = terminated or truncated

    assert check("q_learning", forgetful).mistakes == (MISTAKES["state_kept"],)


def test_a_first_visit_counted_from_the_end_is_recognised() -> None:
    def backwards(env, q, episodes, discount, epsilon, rng):
        counts = np.zeros(q.shape)
        for _ in range(episodes):
            state, _ = env.reset()
            steps, over = [], False
            while not over:
                action = int(epsilon_greedy(q[state], epsilon, rng))
                next_state, reward, terminated, truncated, _ = env.step(action)
                steps.append((state, action, reward))
                state, over = next_state, terminated or truncated
            following, seen = 0.0, set()
            for at, chosen, reward in reversed(steps):
                following = reward + discount * following
                if (at, chosen) not in seen:
                    seen.add((at, chosen))
                    counts[at, chosen] += 1
                    q[at, chosen] += 1 / counts[at, chosen] * (following - q[at, chosen])

    assert check("monte_carlo", backwards).mistakes == (MISTAKES["last_visit"],)


def test_an_unknown_mistake_is_not_explained() -> None:
    def odd(env, q, *others):
        SARSA(env, q, *others)
        q *= 1.5

    report = check("sarsa", odd)
    assert not report.passed
    assert report.mistakes == ()
    assert report.results[0].difference is not None
    assert report.results[0].difference.episode == 2  # after the last of three episodes


def test_the_first_difference_has_its_episode_step_and_numbers() -> None:
    def late(env, q, episodes, learning_rate, discount, epsilon, rng):
        """Sarsa until the third step, and then another learning rate."""
        steps = 0
        for _ in range(episodes):
            state, _ = env.reset()
            action, over = epsilon_greedy(q[state], epsilon, rng), False
            while not over:
                next_state, reward, terminated, truncated, _ = env.step(action)
                over, next_action, target = terminated or truncated, 0, reward
                if not terminated:
                    next_action = epsilon_greedy(q[next_state], epsilon, rng)
                    target = reward + discount * q[next_state, next_action]
                rate = learning_rate if steps < 2 else 0.25
                q[state, action] += rate * (target - q[state, action])
                state, action, steps = next_state, next_action, steps + 1

    difference = check("sarsa", late).results[0].difference
    assert difference is not None
    assert (difference.episode, difference.step, difference.quantity) == (0, 2, "q")
    (at,) = np.argwhere(difference.yours != difference.reference)
    assert difference.yours[tuple(at)] == difference.reference[tuple(at)] / 2 == -0.25
    assert re.search(
        r"state \d+ \(row \d, column \d+\); action \d \((up|down|left|right)\); reward -1", str(difference)
    )
    assert f"q[{at[0]}, {at[1]}]: before 0, yours -0.25, reference -0.5" in str(difference)


def test_the_difference_of_a_solution_that_stops_early_has_a_field() -> None:
    (one, *_) = find("sarsa").checks
    reference = Record()
    one.run(SARSA, reference, 60.0)
    early = Record(reference.events[:-1])
    shorter, longer = first_difference(early, reference), first_difference(reference, early)
    assert shorter is not None
    assert longer is not None
    assert (shorter.stopped_early, longer.stopped_early) == (True, False)
    assert "your function has ended, the reference continues" in str(shorter)
    assert "the reference has ended, your function continues" in str(longer)


def test_rounding_counts_unless_it_is_allowed() -> None:
    def average(estimates, counts, action, reward):
        counts[action] += 1
        estimates[action] = estimates[action] * (1 - 1 / counts[action]) + reward / counts[action]

    report = check("sample_average", average)
    assert not report.passed
    assert "except for rounding" in str(report)
    assert str(report).endswith("\nNothing differs by more than rounding: exact=False accepts this")
    assert report.mistakes == ()
    assert check("sample_average", average, exact=False).passed
    assert not check("sample_average", lambda *_: None, exact=False).passed


def test_a_mistake_is_recognised_behind_another_rounding() -> None:
    def rounded(env, q, episodes, learning_rate, discount, epsilon, rng):
        for _ in range(episodes):
            state, _ = env.reset()
            over = False
            while not over:
                action = epsilon_greedy(q[state], epsilon, rng)
                next_state, reward, terminated, truncated, _ = env.step(action)
                over = terminated or truncated
                target = reward + (0 if over else discount * q[next_state].max())
                q[state, action] += learning_rate * target - learning_rate * q[state, action]
                state = next_state

    report = check("q_learning", rounded)
    assert report.mistakes == (MISTAKES["truncation"],)
    assert not report.recognition.exact
    assert "gives the same numbers as your function in all checks, except for rounding:" in report.recognition.lines[0]


def test_only_finished_checks_are_compared_with_mistakes() -> None:
    def stops(env, q, episodes, learning_rate, discount, epsilon, rng):
        if episodes > 3:
            raise RuntimeError("enough")
        find("sarsa").model(env, q, episodes, discount, learning_rate, epsilon, rng)

    report = check("sarsa", stops)
    assert report.mistakes == (MISTAKES["swapped_rates"],)
    assert "in the checks that it finished:" in report.recognition.lines[0]


def test_finished_checks_that_are_right_do_not_claim_a_mistake() -> None:
    def stops(values, epsilon, rng):
        if epsilon == 0.3:
            raise ValueError("oops")
        return int(epsilon_greedy(values, epsilon, rng))

    report = check("epsilon_greedy", stops)
    assert [result.passed for result in report.results] == [True, True, True, False]
    assert report.mistakes == ()
    assert report.recognition.lines == []


def test_a_copied_table_and_an_unused_generator_are_remarked() -> None:
    report = check("sarsa", lambda env, q, *others: SARSA(env, q.copy(), *others))
    assert any("q never changes" in remark for remark in report.advice)

    def own_generator(env, q, episodes, learning_rate, discount, epsilon, rng):
        SARSA(env, q, episodes, learning_rate, discount, epsilon, np.random.default_rng(0))

    assert any("rng is never used" in remark for remark in check("sarsa", own_generator).advice)


def test_returned_arrays_are_not_said_to_change_in_place() -> None:
    report = check("value_iteration", lambda P, *_: (np.zeros(len(P)), np.zeros(len(P), dtype=np.int64)))  # noqa: N803
    assert not report.passed
    assert report.advice == ()


def test_a_report_is_an_assertion_and_a_table() -> None:
    report = check(7, book_sarsa)
    with pytest.raises(AssertionError, match=r"exercise 7, sarsa: 0 of 3 checks passed"):
        report.assert_passed()
    shown = report._repr_html_()
    assert "FAILED" in shown
    assert "first difference" in shown
    assert "truncation is treated as termination" in shown
    assert repr(report) == "<Report on exercise 7, sarsa: 0 of 3 checks passed>"


def test_arrays_in_a_report_are_not_broken_within_a_row() -> None:
    report = check("policy_evaluation", lambda P, policy, values, discount: values + 1.0)  # noqa: N803
    lines = str(report).splitlines()
    assert max(map(len, lines)) <= 86
    start = next(index for index, line in enumerate(lines) if line.strip().startswith("values = ["))
    end = next(index for index, line in enumerate(lines) if line.strip().startswith("discount = "))
    width = lines[start].index("[") + 1
    assert end - start > 1
    assert all(line[:width].isspace() and line[width] in " -0123456789." for line in lines[start + 1 : end])
    assert "and 1 more entry" in str(first_difference(recorded(np.arange(4.0)), recorded(np.arange(4.0) + 1)))


def recorded(value: np.ndarray) -> Record:
    return Record([Event("call 0", "values", value)])


def test_exercises_are_found_by_name_and_number() -> None:
    assert [exercise.number for exercise in EXERCISES.values()] == list(range(1, 13))
    assert find("Q-learning") is find(8) is find("8") is EXERCISES["q_learning"]
    assert repr(find(8)) == "<Exercise 8, q_learning: Q-learning, section 6.5>"
    with pytest.raises(ValueError, match=r"there is no exercise 'sarsaa' \(did you mean 'sarsa'\?\)"):
        find("sarsaa")
    with pytest.raises(ValueError, match="there is no exercise 13: they are numbered from 1 to 12; "):
        find(13)
    with pytest.raises(TypeError, match="exercise must be a name, a number or an Exercise, got None"):
        find(None)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="solution must be a function, such as sarsa, got 3"):
        qtab.exercises.check("sarsa", 3)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="seconds must be positive"):
        check("sarsa", SARSA, seconds=0)


def test_mistakes_that_hardly_converge_do_not_delay_a_report() -> None:
    exercise, sweeps = find("value_iteration"), definitions.value_iteration.MOST_SWEEPS
    random_walk = partial(exercise.model, wrong=frozenset(["average_not_max", "no_discount"]))  # beside a cliff
    with pytest.raises(Misuse, match=f"no convergence in {sweeps} sweeps"):
        exercise.checks[0].run(random_walk, Record(), 60.0)

    def fewer_sweeps(P, discount, tolerance):  # noqa: N803 - Gymnasium's name
        return exercise.model(P, discount, 100 * tolerance)

    report = check("value_iteration", fewer_sweeps)
    assert not report.passed
    assert report.mistakes == ()
