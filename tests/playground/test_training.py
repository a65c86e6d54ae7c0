"""Run, stop, step, episode and reset; what a finished run shows."""

import pytest

from qtab.playground import definitions
from support.playground import Playground

pytestmark = pytest.mark.browser

CANVASES = ("curve", "motion", "values", "visits")


@pytest.mark.parametrize("environment", list(definitions()["environments"]))
def test_nothing_is_blank(playground: Playground, environment: str) -> None:
    playground.open(f"#env={environment.replace(' ', '%20')}&episodes=50")
    canvases = [*CANVASES, *(["best"] if playground.page.locator("#best-panel").is_visible() else [])]
    for canvas in canvases:
        assert playground.colors(canvas) > 3, canvas
        alternative = playground.page.locator(f"#{canvas}").get_attribute("aria-label")
        assert alternative is not None
        assert len(alternative) > 20


def test_steps_and_episodes_show_the_updates(playground: Playground) -> None:
    playground.open("#env=grid&example=0")
    playground.page.locator("#reset").click()
    assert playground.settled().result()["done"] == 0
    playground.page.locator("#step").click()
    playground.settled()
    assert sum(playground.result()["visits"]) == 1
    assert "Episode 1, step 1" in playground.text("inspection")
    assert "Q(S, A)" in playground.text("inspection")
    playground.page.locator("#step").click()
    playground.settled()
    assert sum(playground.result()["visits"]) == 2
    playground.page.locator("#one-episode").click()
    assert playground.settled().result()["done"] == 1
    playground.page.locator("#run").click()
    result = playground.settled().result()
    assert (result["state"], result["done"]) == ("finished", 500)


def test_stepping_to_the_end_learns_what_running_does(playground: Playground) -> None:
    playground.open("#env=grid&episodes=5")
    ran = playground.result()
    playground.page.locator("#reset").click()
    playground.settled()
    playground.page.locator("#step").click()
    playground.settled()
    for _ in range(5):
        playground.page.locator("#one-episode").click()
        playground.settled()
    stepped = playground.result()
    assert stepped == ran


def test_a_long_run_can_be_stopped_and_continued(playground: Playground) -> None:
    playground.open("#env=MountainCar-v0&episodes=100")
    playground.type_number("episodes", "50000")
    playground.page.wait_for_function(
        "() => playground.training.state === 'training' && playground.view.result.done > 0"
    )
    playground.page.locator("#stop").click()
    stopped = playground.settled().result()
    assert stopped["state"] == "paused"
    assert 0 < stopped["done"] < 50_000
    assert "Paused" in playground.text("status")
    playground.page.locator("#one-episode").click()
    assert playground.settled().result()["done"] in (stopped["done"] + 1, stopped["done"])


def test_sixteen_seeds_are_sixteen_runs(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1&seeds=16&seed=3")
    many = playground.result()
    assert many["seeds"] == list(range(3, 19))
    playground.open("#env=CliffWalking-v1&seed=3")
    one = playground.result()
    assert many["returns"][: one["done"]] == one["returns"]
    assert many["values"] == one["values"]


def test_a_paused_episode_names_the_next_action(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1&example=0")
    playground.page.locator("#reset").click()
    playground.settled()
    for _ in range(3):
        current = playground.page.evaluate("() => playground.view.result.current")
        actions = definitions()["environments"]["CliffWalking-v1"]["actions"]
        if current:
            assert f"next action: {actions[current['nextAction']]}." in playground.text("motion-caption")
            expected = current["nextAction"]
        playground.page.locator("#step").click()
        playground.settled()
        if current:
            first = playground.page.evaluate("() => playground.view.result.inspection.updates.at(-1)")
            assert first["action"] == expected


def test_a_long_greedy_episode_is_not_said_to_end(playground: Playground) -> None:
    stuck = "#env=FrozenLake-v1%20(not%20slippery)&initial_q=0&epsilon=0&episodes=2"
    playground.open(f"{stuck}&max_episode_steps=2500")
    caption = playground.text("motion-caption")
    assert caption == "Greedy episode: return 0 in its first 2,000 steps; the rest is not shown."
    playground.open(f"{stuck}&max_episode_steps=1500")
    assert playground.text("motion-caption").endswith("in 1,500 steps: time is up.")


@pytest.mark.parametrize(
    ("limit", "names", "shows_best"),
    [(200, ["threshold", "best known"], True), (300, [], True), (100, [], False)],
)
def test_marks_belong_to_the_time_limit(playground: Playground, limit: int, names: list[str], shows_best: bool) -> None:
    playground.open(f"#env=MountainCar-v0&episodes=20&max_episode_steps={limit}")
    marks = "() => playground.view.marks.of(playground.store, playground.view.result).map(({ name }) => name)"
    assert playground.page.evaluate(marks) == names
    assert playground.page.locator("#best-panel").is_visible() == shows_best
    if shows_best:
        assert ("Its expected return is" in playground.text("best-caption")) == bool(names)


def test_the_greatest_return_is_not_said_to_be_that_of_a_discounting_policy(playground: Playground) -> None:
    playground.open("#env=FrozenLake-v1&episodes=20&discount=0.5")
    assert "The greatest expected return, without discounting, is 0.7442." in playground.text("best-caption")
    playground.open("#env=FrozenLake-v1&episodes=20&discount=1")
    assert "Its expected return is 0.7442." in playground.text("best-caption")


def test_two_tables_are_shown_beside_the_optimum(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1&algorithm=double_q_learning&learning_rate=1&epsilon=1&episodes=300&seed=1")
    values, best = playground.page.evaluate(
        "() => [Array.from(playground.view.result.map.values), Array.from(playground.view.result.best.values)]"
    )
    assert values[35] == best[35] == -1
    assert "averaged over both tables" in playground.text("inspection")


def test_a_selected_state_is_watched_in_the_next_run(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1&example=0")
    playground.page.evaluate("() => playground.training.inspect(25)")
    playground.settled()
    assert playground.page.evaluate("() => playground.training.watched()") == {"cell": 25, "columns": 12, "rows": 4}
    playground.type_number("learning_rate", "0.4")
    playground.settled()
    assert playground.page.evaluate("() => playground.view.result.inspection.cell") == 25


def test_divergence_is_said(playground: Playground) -> None:
    playground.open(
        "#env=MountainCar-v0&algorithm=sarsa_lambda&discretizer=tiles&learning_rate=2&trace_decay=1&discount=1"
        "&traces=accumulating&episodes=500&epsilon=1&epsilon_schedule=constant"
    )
    assert playground.result()["state"] == "diverged"
    assert "diverged" in playground.text("problem")
    assert "α" in playground.text("problem")


def test_visits_are_shown_where_values_diverged(playground: Playground) -> None:
    playground.open(
        "#env=MountainCar-v0&algorithm=sarsa&discretizer=fourier&order=5&learning_rate=1&discount=1&episodes=500&epsilon=0"
    )
    assert playground.result()["state"] == "diverged"
    values = "() => [...playground.view.visits.content.map.values].every(Number.isNaN)"
    assert playground.page.evaluate(values)
    shares = (
        "() => { const { map, share } = playground.view.visits.content; return [...map.visits.keys()].map(share); }"
    )
    shown = playground.page.evaluate(shares)
    assert min(shown) == 0
    assert max(shown) == pytest.approx(1)


def test_examples_show_failure_and_cure(playground: Playground) -> None:
    playground.open("#env=FrozenLake-v1")
    failed = playground.result()
    assert max(failed["returns"]) == 0
    playground.page.locator("#examples button").nth(1).click()
    cured = playground.settled().result()
    assert sum(cured["returns"][-1000:]) > 500
    assert "initial values of 1" in playground.text("look")


def test_values_that_differ_are_shown_differently(playground: Playground) -> None:
    playground.open("#env=MountainCar-v0&example=0")
    playground.page.wait_for_function("() => playground.view.result.inspection")
    values = playground.page.evaluate("() => Array.from(playground.view.result.inspection.actionValues)")
    shown = playground.page.locator(".action-values tbody tr td:nth-of-type(1)").all_inner_texts()
    assert len(set(shown)) == len(set(values)) == 3
    assert max(values) - min(values) < 0.01, "four digits would show them alike"
