"""``qtab.Explanation``: some steps of an episode, each with its choice and its updates."""

from dataclasses import dataclass, field

from qtab.config import Config
from qtab.explanation.records import ExplainedStep
from qtab.explanation.text import html, text


@dataclass(frozen=True, eq=False, repr=False)
class Explanation:
    """Steps of an episode: observations, actions with their reasons, and updates. ``print`` shows them."""

    config: Config
    """The config of the run."""
    episode: int
    """The number of the episode, from 0."""
    steps: tuple[ExplainedStep, ...]
    """The steps, in order."""
    episode_length: int
    """The number of steps of the whole episode."""
    episode_return: float
    """The return of the whole episode."""
    learning_rate: float
    """The learning rate in this episode, before it is shared by the active rows or divided by the visits."""
    seconds: float = field(repr=False)
    """The wall-clock time to repeat the run up to the end of the episode."""

    def __repr__(self) -> str:
        shown = f"step {self.steps[0].step}"
        if len(self.steps) > 1:
            shown = f"steps {self.steps[0].step} to {self.steps[-1].step}"
        return (
            f"<Explanation of {self.config.env}: {self.config.algorithm}, seed {self.config.seed}, "
            f"episode {self.episode}, {shown} of {self.episode_length}; print shows them>"
        )

    def __len__(self) -> int:
        return len(self.steps)

    def __getitem__(self, index: int) -> ExplainedStep:
        return self.steps[index]

    def __str__(self) -> str:
        """Returns the steps as aligned text."""
        return text(self.heading, self.steps)

    def _repr_html_(self) -> str:
        """HTML for notebooks: the steps as a table."""
        return html(self.heading, self.steps)

    @property
    def heading(self) -> str:
        """The run, the episode and its rates, in one line."""
        config, choice, length = self.config, self.steps[0].choice, self.episode_length
        if choice.epsilon is not None:
            rate = f"epsilon {choice.epsilon:.6g}"
        else:
            name = "confidence" if config.exploration == "ucb" else "temperature"
            rate = f"{name} {getattr(config, name):.6g}"
        return (
            f"{config.env}, {config.algorithm}, seed {config.seed}, episode {self.episode}: "
            f"{length} step{'' if length == 1 else 's'}, return {self.episode_return:.6g}; "
            f"{rate}, α = {self.learning_rate:.6g}, γ = {config.discount:.6g}"
        )
