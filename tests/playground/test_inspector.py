"""Every equation that the page prints holds for the numbers in it."""

import re

import pytest

from qtab.config.options import LEARNS_WEIGHTED
from qtab.playground.settings import OFFERED
from support.playground import Playground

pytestmark = pytest.mark.browser

GRID = "env=CliffWalking-v1&episodes=40&max_episode_steps=40&epsilon=0.4&epsilon_schedule=constant&discount=0.95"
TILES = "env=MountainCar-v0&discretizer=tiles&tilings=8&tiles=4&episodes=20&discount=0.95&terminal_update=target"
FOURIER = "env=MountainCar-v0&discretizer=fourier&order=3&episodes=20&discount=0.95"  # with accumulating traces
CHANGES = (
    "learning_rate=0.3",
    "learning_rate=0.3&on_truncation=terminate",
    "learning_rate=1&learning_rate_schedule=visits&min_learning_rate=0.05",
    "learning_rate=0.7&learning_rate_schedule=linear&exploration=softmax&temperature=2",
)
EQUATIONS = """() => [...document.querySelectorAll(".updates li")].map((item) => {
  const symbols = item.querySelector(".symbols") ?? document.querySelector(".inspected .symbols");
  const numbers = item.querySelector(".equation:not(.symbols)");
  return [item.querySelector(".when").innerText, symbols.innerText, numbers.innerText];
})"""
NUMBER = re.compile(r"\d[\d,]*\.?\d*(?:e-?\d+)?")


class Rounded:
    """A number that was rounded to five digits, and how far it may be from the exact one."""

    def __init__(self, value: float, error: float | None = None) -> None:
        self.value = value
        self.error = 5e-5 * abs(value) if error is None else error

    def __neg__(self) -> "Rounded":
        return Rounded(-self.value, self.error)

    def __add__(self, other: "Rounded") -> "Rounded":
        return Rounded(self.value + other.value, self.error + other.error)

    def __sub__(self, other: "Rounded") -> "Rounded":
        return self + -other

    def __mul__(self, other: "Rounded") -> "Rounded":
        error = abs(self.value) * other.error + abs(other.value) * self.error + self.error * other.error
        return Rounded(self.value * other.value, error)


def evaluated(text: str) -> Rounded:
    """Returns the value of one side of an equation, as the page prints it."""
    plain = text.replace("−", "-").replace("·", "*").replace("[", "(").replace("]", ")")
    assert not set(NUMBER.sub("", plain)) - set("+-*() "), text
    code = NUMBER.sub(lambda number: f"Rounded({number[0].replace(',', '')})", plain)
    value: Rounded = eval(code, {"Rounded": Rounded})  # noqa: S307 - numbers and operators alone
    return value


def check_equations(playground: Playground, context: str) -> int:
    """Checks the equations that are shown, and returns how many there are."""
    shown: list[tuple[str, str, str]] = playground.page.evaluate(EQUATIONS)
    for when, symbols, numbers in shown:
        if "[" not in symbols:
            assert symbols.endswith("← R"), context
            assert numbers.split(" ← ")[1] in when.replace("reward ", ""), (context, when, numbers)
            continue
        left, right = numbers.split(" = ")
        difference = evaluated(left) - evaluated(right)
        assert abs(difference.value) <= difference.error + 1e-12, (context, when, symbols, numbers)
        assert ("Σ αᵢ xᵢ²" in symbols) == ("fourier" in context), context
        # As many factors and terms as the symbols say: α z [...] has two factors before the bracket.
        before = symbols.split("[")[0]
        assert left.split("[")[0].count("·") == ("α" in before) + ("z" in before), (context, symbols, numbers)
        ended = "terminal" in when
        has_next = "·" in left.split("[")[1].split("]")[0]
        assert has_next == ("γ" in symbols and not ended), (context, when, symbols, numbers)
    return len(shown)


@pytest.mark.parametrize("algorithm", OFFERED["algorithm"])
def test_every_printed_equation_holds(playground: Playground, algorithm: str) -> None:
    playground.open("#env=CliffWalking-v1&episodes=20")
    restore = "text => { playground.restore(playground.store, text); }"
    count = 0
    for base, cells in ((GRID, (36, 24, 37)), (TILES, (None,)), (FOURIER, (None,))):
        if (base is TILES and algorithm.startswith("dyna")) or (base is FOURIER and algorithm not in LEARNS_WEIGHTED):
            continue
        for change in CHANGES if base is not FOURIER else ("", CHANGES[1].replace("0.3", "0.01")):
            if "visits" in change and algorithm == "true_online_sarsa_lambda":
                continue
            context = f"{base}&algorithm={algorithm}&{change}"
            playground.page.evaluate(restore, context)
            playground.settled()
            for cell in cells:
                if cell is not None:
                    playground.page.evaluate("cell => playground.training.inspect(cell)", cell)
                    playground.settled()
                count += check_equations(playground, context)
    assert count > 30


def test_an_episode_that_is_cut_is_said_to_end_as_the_learner_takes_it(playground: Playground) -> None:
    for handling, text in (
        ("bootstrap", "the time limit ends the episode"),
        ("terminate", "the time limit ends the episode, and the next state counts as terminal"),
    ):
        playground.open(f"#{GRID}&max_episode_steps=1&on_truncation={handling}")
        when = playground.page.locator(".updates .when").all_inner_texts()
        assert len(when) == 5
        assert all(each.endswith(f"; {text}") for each in when), when


def test_an_update_that_is_not_of_its_step_is_said_to_follow_it(playground: Playground) -> None:
    playground.open(f"#{GRID}&algorithm=n_step_sarsa&n_steps=4")
    when = playground.page.locator(".updates .when").all_inner_texts()
    assert len(when) == 5
    assert all(", after step " in each for each in when), when


def test_an_assigned_value_is_the_reward(playground: Playground) -> None:
    playground.open("#env=grid&layout=SG&terminal_update=assign&episodes=10&goal_reward=7&step_reward=-1")
    assert check_equations(playground, "assign") == 5
    assert "Q(S, A) ← 7" in playground.text("inspection")
