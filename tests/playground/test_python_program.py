"""Copy as Python: the program runs, learns the page's table and prints the figure below the learning curve."""

import base64
import contextlib
import io
import re
from typing import Any

import numpy as np
import pytest

from qtab.playground import definitions
from support.playground import Playground

pytestmark = pytest.mark.browser

PROGRAMS = (
    "#env=MountainCar-v0&example=0",
    "#env=MountainCar-v0&discretizer=tiles&algorithm=true_online_sarsa_lambda&tilings=4&tiles=5,6&episodes=40&learning_rate=1.5",
    "#env=MountainCar-v0&discretizer=bins&bins=7,9&algorithm=n_step_sarsa&n_steps=3&episodes=60&initial_q=0&seed=5",
    "#env=CartPole-v1&discretizer=bins&bins=3,3,6,6&episodes=100&learning_rate_schedule=linear",
    "#env=FrozenLake-v1&example=1",
    "#env=FrozenLake8x8-v1%20(not%20slippery)&algorithm=double_q_learning&episodes=300&seed=11",
    "#env=CliffWalking-v1&algorithm=dyna_q_plus&planning_steps=5&episodes=40&learning_rate_schedule=visits&seeds=16&seed=2",
    "#env=WindyGridWorld&example=0",
    "#env=grid&example=2",
    "#env=grid&layout=S..W/.WG./S...&step_reward=-0.5&goal_reward=3&rewards=2,1,-4/0,1,2.5&wind=0,1,0,0&episodes=50"
    "&max_episode_steps=77&exploration=softmax&temperature=0.7&seeds=16",
    # Where the page's defaults, or those of the package, would otherwise decide: of every task, and of every choice.
    *(f"#env={name}&episodes=60" for name, known in definitions()["environments"].items() if not known["chaotic"]),
    # Episodes too short for a difference in the last bit to grow.
    "#env=Acrobot-v1&episodes=60&max_episode_steps=20",
    "#env=Acrobot-v1&example=2&episodes=20&max_episode_steps=20",
    "#env=CliffWalking-v1&example=0",
    "#env=CliffWalking-v1&example=1&seeds=16",
    "#env=MountainCar-v0&episodes=30&max_episode_steps=201&epsilon=0.3&epsilon_schedule=constant&learning_rate=0.1"
    "&discount=0.9&on_truncation=terminate&terminal_update=target&ties=random&bit_generator=MT19937",
    "#env=MountainCar-v0&episodes=30&epsilon_schedule=exponential&learning_rate_schedule=exponential&algorithm=sarsa_lambda",
    "#env=FrozenLake-v1&episodes=150&algorithm=expected_sarsa&exploration=epsilon_greedy&epsilon=0.5&min_epsilon=0.1"
    "&epsilon_warm_up=20&learning_rate_schedule=linear&min_learning_rate=0.01&learning_rate_warm_up=10",
    "#env=CartPole-v1&discretizer=tiles&tilings=4&tiles=3&episodes=20&algorithm=watkins_q_lambda&traces=replacing",
    "#env=MountainCar-v0&discretizer=fourier&order=4&coupled=false&algorithm=sarsa&learning_rate=0.004&episodes=60",
    "#env=MountainCar-v0&discretizer=fourier&algorithm=watkins_q_lambda&episodes=60",
)
TABLE = """async () => {
  const table = await playground.engine.table(0);
  const bytes = new Uint8Array(table.buffer, table.byteOffset, table.byteLength);
  let text = "";
  for (const byte of bytes) text += String.fromCharCode(byte);
  return btoa(text);
}"""


@pytest.mark.parametrize("fragment", PROGRAMS)
def test_the_program_learns_the_same_table(playground: Playground, fragment: str) -> None:
    playground.open(fragment)
    page = playground.page
    table = np.frombuffer(base64.b64decode(page.evaluate(TABLE)), np.float64)
    page.locator("#python-open").click()
    program = page.locator("#python-code").inner_text()
    names: dict[str, Any] = {"__name__": "__main__"}
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        exec(compile(program, "copied.py", "exec"), names)  # noqa: S102 - what a reader does with it
    run = names["run"]
    if run.config.discretizer == "fourier":  # the cosines of the page differ in the last bit
        np.testing.assert_allclose(run.tables.ravel(), table, rtol=0, atol=1e-9)
    else:
        assert run.tables.tobytes() == table.tobytes()
    assert run.episode_returns.tolist() == playground.result()["returns"][: len(run.episode_returns)]
    assert "array" not in printed.getvalue()
    figure = float(printed.getvalue().split("\n")[0])
    # The page sums in another order.
    assert figure == pytest.approx(page.evaluate("() => playground.view.curve.shown.atEnds.mean[1]"), rel=1e-12)
    shown = re.search(r"Mean (.+) of the last (\d+) episodes?: ([−\d.,e]+?)(\.$| ±)", playground.text("curve-summary"))
    assert shown is not None
    assert f"the mean {shown[1]} of the last {shown[2]} episode" in program
    assert f"{float(shown[3].replace('−', '-').replace(',', '')):.4g}" == f"{figure:.4g}"
    for name, value in playground.state()["settings"].items():
        assert f"{name}=" in program
        kept = getattr(run.config, name)
        # One number of tiles or bins stands for all components.
        expected = np.broadcast_to(value, np.shape(kept)).tolist() if isinstance(kept, tuple) else value
        assert (list(kept) if isinstance(kept, tuple) else kept) == expected, name


def test_copying_says_that_it_was_copied(playground: Playground) -> None:
    playground.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    playground.open("#env=CliffWalking-v1&episodes=20")
    page = playground.page
    page.locator("#python-open").click()
    program = page.locator("#python-code").inner_text()
    assert page.locator("#python-copy").inner_text() == "Copy"
    page.locator("#python-copy").click()
    page.wait_for_function("() => document.querySelector('#python-copy').textContent === 'Copied'")
    assert page.evaluate("() => navigator.clipboard.readText()").strip() == program.strip()
