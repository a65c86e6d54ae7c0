"""Figures 11.2, 11.5 and 11.6: methods on Baird's counterexample, sampled and in expectation."""

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import islice
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias

import gymnasium as gym
import numpy as np

from qtab.book.drawing import Panel, draw_lines, draw_panels
from qtab.book.experiment import Experiment, Outcome
from qtab.book.line import Line, LineStyle, line_from_samples
from qtab.book.result import Draw, Result
from qtab.book.runner import FloatArray
from qtab.prediction.linear import LinearGeometry, expected_updates, linear_geometry
from qtab.prediction.linear.expected_updates import ExpectedMethod
from qtab.prediction.reference.off_policy import TDC, OffPolicyUpdate, SemiGradientTD, transitions, weights_by_step

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ENV = "qtab/BairdCounterexample-v0"
DISCOUNT = 0.99
INITIAL_WEIGHTS = (1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 10.0, 1.0)
UPDATES = 1000
UPPER = "w1 to w6"
"""The method, and with it the color, of the weights of the upper states."""
VALUE_ERROR, PROJECTED_ERROR = "√VE", "√PBE"
SETTING = "Baird's counterexample with γ = 0.99, the initial weights (1, 1, 1, 1, 1, 1, 10, 1), 1,000 steps or sweeps; "


@cache
def geometry() -> LinearGeometry:
    """Returns the transition table, the features and the distribution of the counterexample."""
    env: Any = gym.make(ENV).unwrapped
    return linear_geometry(env, env.target, env.features, DISCOUNT, behavior=env.behavior)


@dataclass(frozen=True)
class Sampled:
    """A method whose updates are sampled transitions."""

    is_random: ClassVar[bool] = True
    x_label: ClassVar[str] = "step"
    names: ClassVar[Mapping[str, int]] = {f"w{number + 1}": number for number in range(len(INITIAL_WEIGHTS))}
    """The index of the weight of each line."""

    title: str
    method: type[OffPolicyUpdate]
    learning_rate: float
    second_learning_rate: float = 0.0

    def weights(self, seed: int) -> FloatArray:
        """Returns (updates + 1, d): the weights after each step of the run with a seed."""
        env: Any = gym.make(ENV, disable_env_checker=True)
        plain = env.unwrapped
        method = self.method(np.array(INITIAL_WEIGHTS), self.learning_rate, DISCOUNT, self.second_learning_rate)
        steps = transitions(env, plain.target, plain.behavior, seed)
        return weights_by_step(method, plain.features, islice(steps, UPDATES))


@dataclass(frozen=True)
class Expected:
    """A method that makes its expected update in each sweep."""

    is_random: ClassVar[bool] = False
    x_label: ClassVar[str] = "sweep"
    names: ClassVar[Mapping[str, int]] = {UPPER: 0, "w7": 6, "w8": 7}
    """The index of the weight of each line: the upper states are treated alike, so their weights stay equal."""

    title: str
    method: ExpectedMethod
    learning_rate: float
    second_learning_rate: float | None = None

    def weights(self, seed: int) -> FloatArray:  # noqa: ARG002 - as Sampled
        """Returns (updates + 1, d): the weights after each sweep."""
        return expected_updates(
            geometry(),
            self.method,
            UPDATES,
            self.learning_rate,
            second_learning_rate=self.second_learning_rate,
            initial_weights=INITIAL_WEIGHTS,
        )


Part: TypeAlias = Sampled | Expected
"""The method of a panel."""


def _draw(result: Result, ax: "Axes | None") -> "Axes":
    """Draws a panel for each method."""
    experiment: Any = result.experiment
    panels = []
    for part in experiment.parts:
        prefix = f"{part.title}: "
        lines = [line for line in result.lines if line.name.startswith(prefix)]
        lines = [dataclasses.replace(line, name=line.name.removeprefix(prefix)) for line in lines]
        # One name for the weights of the upper states, which are close together.
        lines[0] = dataclasses.replace(lines[0], name=UPPER)
        lines[1:] = [dataclasses.replace(line, named=line.method != UPPER) for line in lines[1:]]
        panels.append(Panel(part.title, lines, {"x_label": part.x_label}))
    if len(panels) > 1:
        return draw_panels(result, ax, panels, shared_x=False)
    return draw_lines(dataclasses.replace(result, lines=tuple(panels[0].lines)), ax)


@dataclass(frozen=True, kw_only=True, repr=False)
class CounterexampleExperiment(Experiment):
    """The weights, and for some methods also the errors, of methods on Baird's counterexample."""

    parts: Sequence[Part]
    """The methods, one for each panel."""
    errors: Sequence[str]
    """The errors that are drawn."""
    draw: Draw = field(default=_draw, repr=False)
    runs: int = 1
    x_label: str = "step or sweep"
    y_label: str = "weight"
    table_x: tuple[float, ...] | None = (0, 100, 200, 500, 1000)

    @property
    def line_names(self) -> Sequence[str]:
        """The names of the lines, each once."""
        return [f"{part.title}: {name}" for part in self.parts for name in (*part.names, *self.errors)]

    def _run(self, runs: int, seed: int, threads: int, progress: bool | None) -> Outcome:  # noqa: ARG002
        """Runs the sampled methods with every seed, and the expected ones once."""
        lines: list[Line] = []
        for part in self.parts:
            weights = np.stack([part.weights(one) for one in range(seed, seed + (runs if part.is_random else 1))])
            samples = {name: weights[..., number] for name, number in part.names.items()}
            found = {VALUE_ERROR: geometry().value_error, PROJECTED_ERROR: geometry().projected_bellman_error}
            samples |= {name: np.sqrt(found[name](weights)) for name in self.errors}
            for name, sample in samples.items():
                style = LineStyle(method=UPPER if part.names.get(name, len(INITIAL_WEIGHTS)) < 6 else name)
                lines.append(line_from_samples(f"{part.title}: {name}", np.arange(UPDATES + 1), sample, style=style))
        return Outcome(lines)


FIGURE_11_2 = CounterexampleExperiment(
    name="figure-11.2",
    title="instability on Baird's counterexample",
    book=f"{SETTING}α = 0.01; left: off-policy semi-gradient TD(0), right: semi-gradient DP; one run",
    unspecified="the states and actions of the run",
    parts=(
        Sampled("semi-gradient off-policy TD", SemiGradientTD, 0.01),
        Expected("semi-gradient DP", "td", 0.01),
    ),
    errors=(),
)
FIGURE_11_5 = CounterexampleExperiment(
    name="figure-11.5",
    title="TDC on Baird's counterexample",
    book=f"{SETTING}α = 0.005, β = 0.05; left: a run, right: the expected updates",
    unspecified="the states and actions of the run",
    parts=(Sampled("TDC", TDC, 0.005, 0.05), Expected("expected TDC", "tdc", 0.005, 0.05)),
    errors=(VALUE_ERROR, PROJECTED_ERROR),
    y_label="weight or error",
)
FIGURE_11_6 = CounterexampleExperiment(
    name="figure-11.6",
    title="expected emphatic TD on Baird's counterexample",
    book=f"{SETTING}α = 0.03, one-step emphatic TD in expectation",
    unspecified="",
    parts=(Expected("expected emphatic TD", "emphatic_td", 0.03),),
    errors=(VALUE_ERROR,),
    x_label="sweep",
    y_label="weight or error",
)
