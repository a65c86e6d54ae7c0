"""Watching an agent learn: the speed, the agent as it was after some episodes, and another one beside it."""

from typing import Any

import pytest

from support.playground import Playground

pytestmark = pytest.mark.browser

MAP = "({ map }) => [map.values, map.visits, map.greedy].map((each) => Array.from(each))"
PACE = """place => {
  const slider = document.querySelector("#pace");
  slider.value = place === null ? slider.max : place;
  slider.dispatchEvent(new Event("input"));
  return document.querySelector(".watched .value").textContent;
}"""
LOOK = """episodes => {
  const { training } = playground;
  playground.view.past = null;
  document.querySelector("#past").value = 0;
  training.engine.lookBack(episodes, [0, 5, 10, 20, 40]);
}"""


def compared(playground: Playground) -> dict[str, Any]:
    """Waits for the other agent, and returns its result."""
    playground.page.wait_for_function(
        "() => !playground.view.other.isStale && playground.view.other.result.state === 'finished'"
    )
    found: dict[str, Any] = playground.page.evaluate(
        "() => { const { returns, map } = playground.view.other.result;"
        " return { returns: Array.from(returns), values: Array.from(map.values), visits: Array.from(map.visits) }; }"
    )
    return found


def test_a_slow_run_is_watched_and_ends_as_a_fast_one(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1&example=0")
    fast = playground.result()
    assert playground.page.evaluate(PACE, 0) == "1 step a second"
    assert playground.page.evaluate(PACE, 5) == "100 steps a second"
    playground.page.wait_for_function("() => playground.view.result.current?.step > 3")
    assert playground.text("motion-title") == "The agent in training"
    assert playground.page.evaluate("() => playground.training.state") == "training"
    assert playground.text("inspection").startswith("Stop the training to see")
    assert playground.page.evaluate(PACE, None) == "all at once"
    playground.page.wait_for_function("() => playground.training.state === 'finished'")
    assert playground.settled().result() == fast


def test_a_slow_run_can_be_stopped_and_stepped(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1&example=0")
    playground.page.evaluate(PACE, 4)
    playground.page.wait_for_function("() => playground.view.result.current?.step > 1")
    playground.page.locator("#stop").click()
    stopped = playground.settled().result()
    playground.page.locator("#step").click()
    stepped = playground.settled().result()
    assert sum(stepped["visits"]) == sum(stopped["visits"]) + 1


def test_an_episode_ends_where_it_ends_at_any_speed(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1&example=2")
    playground.page.locator("#reset").click()
    playground.settled()
    playground.page.evaluate(PACE, 8)
    for episodes in (1, 2):
        playground.page.locator("#one-episode").click()
        result = playground.settled().result()
        assert result["done"] == episodes
        assert sum(result["visits"]) == sum(result["lengths"])


@pytest.mark.parametrize("environment", ["CliffWalking-v1", "MountainCar-v0&discretizer=tiles&max_episode_steps=50"])
def test_looking_back_shows_what_was_learned_by_then(playground: Playground, environment: str) -> None:
    playground.open(f"#env={environment}&episodes=40")
    expected = {40: playground.page.evaluate(f"() => ({MAP})(playground.view.result)")}
    playground.page.locator("#reset").click()
    playground.settled()
    expected[0] = playground.page.evaluate(f"() => ({MAP})(playground.view.result)")
    for episode in range(1, 8):
        playground.page.locator("#one-episode").click()
        playground.settled()
        expected[episode] = playground.page.evaluate(f"() => ({MAP})(playground.view.result)")
    playground.page.locator("#run").click()
    playground.page.wait_for_function("() => playground.training.state === 'finished'")
    playground.settled()
    for episode in (7, 3, 40, 0, 5, 3):
        playground.page.evaluate(LOOK, episode)
        playground.page.wait_for_function("episode => playground.view.past?.episodes === episode", arg=episode)
        assert playground.page.evaluate(f"() => ({MAP})(playground.view.past)") == expected[episode], episode


def test_the_slider_looks_back_and_returns(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1&example=0")
    newest = playground.text("motion-caption")
    slider = playground.page.locator("#past")
    slider.focus()
    slider.press("Home")
    playground.page.wait_for_function("() => playground.view.past?.episodes === 0")
    assert playground.text("motion-caption").startswith("Greedy episode after 0 episodes: return −")
    label = playground.page.locator("#values").get_attribute("aria-label")
    assert label is not None
    assert label.endswith("; 0 cells visited.")
    slider.press("ArrowRight")
    playground.page.wait_for_function("() => playground.view.past?.episodes === 8")
    assert slider.get_attribute("aria-valuetext") == "episode 8 of 500"
    slider.press("End")
    playground.page.wait_for_function("() => playground.view.past === null")
    assert playground.text("motion-caption") == newest


def test_time_spent_paused_is_not_caught_up_by_an_episode(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1&example=0")
    playground.page.locator("#reset").click()
    playground.settled()
    assert playground.page.evaluate(PACE, 2) == "5 steps a second"
    playground.page.wait_for_timeout(1500)
    playground.page.evaluate(
        "() => { globalThis.clicked = performance.now(); document.querySelector('#one-episode').click(); }"
    )
    first = playground.page.wait_for_function(
        """() => {
          const step = playground.view.result.current?.step;
          return step && [step, performance.now() - globalThis.clicked];
        }"""
    )
    step, milliseconds = first.json_value()
    assert step < 5 * milliseconds / 1000 + 4


def test_a_run_that_continues_no_longer_looks_back(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1&example=0")
    playground.page.locator("#reset").click()
    playground.settled()
    playground.page.evaluate("() => playground.training.engine.advance('episode', 6)")
    playground.page.wait_for_function("() => playground.view.result.done === 6")
    playground.page.evaluate(
        """() => {
          const slider = document.querySelector("#past");
          slider.value = 3;
          slider.dispatchEvent(new Event("input"));
          document.querySelector("#run").click();
        }"""
    )
    playground.page.wait_for_function("() => playground.training.state === 'finished'")
    playground.page.wait_for_timeout(300)
    assert playground.page.evaluate("() => playground.view.past") is None
    assert playground.text("motion-caption").startswith("Greedy episode: ")


def test_an_answer_that_comes_after_the_slider_returned_is_dropped(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1&example=0")
    shown = playground.page.evaluate(
        """async () => {
          const { training, view } = playground;
          const slider = document.querySelector("#past");
          for (const place of [30, slider.max]) {
            slider.value = place;
            slider.dispatchEvent(new Event("input"));
          }
          await new Promise((resolve) => setTimeout(resolve, 300));
          const { id } = training;
          training.receive({ type: "past", id, episodes: 250, map: view.result.map, episode: null });
          return view.past;
        }"""
    )
    assert shown is None


def test_an_agent_at_its_end_waits_for_the_other(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1&episodes=20&compare=sarsa")
    finished = compared(playground)
    identity = playground.page.evaluate("() => playground.training.id")
    for button in ("step", "one-episode"):
        playground.page.evaluate("() => playground.agents()[1].reset()")
        playground.page.wait_for_function("() => playground.agents()[1].state === 'paused'")
        playground.page.locator(f"#{button}").click()
        playground.page.wait_for_function("() => playground.view.other.result.map.visits.some(Boolean)")
        assert playground.text("run") == "Continue"
        playground.page.locator("#run").click()
        assert compared(playground) == finished
        assert playground.text("run") == "Run again"
    assert playground.page.evaluate("() => playground.training.id") == identity
    playground.page.locator("#run").click()
    assert playground.page.evaluate("() => playground.training.id") == identity + 1
    playground.settled()


def test_an_agent_that_is_no_longer_compared_stops(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1&episodes=20&compare=sarsa")
    compared(playground)
    playground.page.evaluate(PACE, 0)
    playground.page.evaluate("() => { globalThis.other = playground.agents()[1]; }")
    playground.page.locator("#compared").select_option("")
    playground.page.wait_for_function("() => other.state === 'paused'")
    assert playground.page.evaluate("() => playground.training.state") == "training"
    assert playground.page.evaluate("() => playground.view.other.isStale")


def test_two_agents_share_axes_and_colors(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1&algorithm=sarsa&episodes=300&epsilon=0.1&seed=3")
    alone = playground.result()
    playground.page.locator("#set-algorithm").select_option("q_learning")
    playground.page.locator("#compared").select_option("sarsa")
    other = compared(playground)
    playground.settled()
    assert other["returns"] == alone["returns"]
    assert other["values"] == alone["values"]
    assert playground.text("values-legend") == playground.text("other-legend")
    assert playground.text("other-title") == "What Sarsa learned"
    [returns, others] = [sum(each["returns"][-60:]) / 60 for each in (playground.result(), other)]
    mean = f"Mean return of the last 60 episodes: Q-learning: {returns:.4g}; Sarsa: {others:.4g}."
    assert (
        playground.text("curve-summary")
        == f"{mean.replace('-', '−').replace('Q−', 'Q-')} One seed can be lucky: compare over 16 seeds."
    )
    assert playground.colors("other") > 3
    playground.page.locator("#one-episode").click()
    playground.page.locator("#compared").select_option("")
    playground.settled()
    assert playground.page.locator("#other-panel").is_hidden()


def test_an_address_keeps_the_agent_to_compare_with(playground: Playground) -> None:
    playground.open("#env=CliffWalking-v1&example=0&compare=expected_sarsa&seeds=16")
    compared(playground)
    playground.page.wait_for_function("() => !playground.view.isStale")
    assert "compare=expected_sarsa" in playground.page.evaluate("() => playground.fragment(playground.store)")
    assert playground.text("curve-summary").endswith("(95 % interval of the mean of 16 seeds).")


@pytest.mark.parametrize("word", ["q_learning", "none", "__proto__", "monte_carlo"])
def test_an_agent_that_cannot_be_compared_is_left_out(playground: Playground, word: str) -> None:
    playground.open(f"#env=CliffWalking-v1&example=0&compare={word}")
    assert playground.text("problem").endswith("left out or changed: compare.")
    assert playground.page.locator("#other-panel").is_hidden()


def test_an_impossible_agent_is_disabled_with_the_reason(playground: Playground) -> None:
    playground.open("#env=MountainCar-v0&discretizer=tiles&episodes=20")
    options = playground.page.locator("#compared option")
    texts = options.all_inner_texts()
    assert "Q-learning (this agent)" in texts
    assert "Dyna-Q (not with Tile coding)" in texts
    assert playground.page.locator('#compared option[value="dyna_q"]').is_disabled()


def test_an_agent_that_does_not_fit_beside_another_is_refused_alone(playground: Playground) -> None:
    playground.open("#env=CartPole-v1&discretizer=bins&bins=41&episodes=3&compare=dyna_q")
    playground.page.locator("#problem").wait_for()
    assert playground.result()["state"] == "finished"
    assert playground.text("problem").startswith("Dyna-Q could not be trained to compare with: 1 run with a table of ")
    assert playground.page.locator("#other-panel").is_hidden()
    playground.page.locator("#compared").select_option("sarsa")
    compared(playground)
    assert playground.page.locator("#problem").is_hidden()
