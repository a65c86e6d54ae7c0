"""Copy as Python: the program runs and learns the page's table."""

import base64
import contextlib
import io
from typing import Any

import numpy as np
import pytest

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
    assert program.strip() == page.evaluate("() => playground.pythonProgram(playground.store)").strip()
    names: dict[str, Any] = {"__name__": "__main__"}
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        exec(compile(program, "copied.py", "exec"), names)  # noqa: S102 - what a reader does with it
    run = names["run"]
    assert run.tables.tobytes() == table.tobytes()
    assert run.episode_returns.tolist() == playground.result()["returns"][: len(run.episode_returns)]
    assert "array" not in printed.getvalue()
    page.locator("#python-copy").click()
    page.wait_for_function("() => document.querySelector('#python-copy').textContent.includes('op')")
