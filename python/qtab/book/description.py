"""The description of an experiment: its name, its settings in the book, and the layout of its table and figure."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import ClassVar


@dataclass(frozen=True, kw_only=True, repr=False)
class Description:
    """The description of an experiment, with the layout of its table and figure."""

    counts_failures: ClassVar[bool] = False
    """Whether the table has the numbers of truncated episodes and of runs that diverged."""

    name: str
    """The kind of the experiment and its number in the book: ``"figure-10.4"``."""
    title: str
    book: str
    """The settings that the book states."""
    unspecified: str
    """The settings that the book does not state, with the values used here."""
    runs: int
    """The number of runs of each setting: that of the book, unless ``book`` gives another one."""
    x_label: str
    y_label: str
    table_x: tuple[float, ...] | None = None
    """The points that the printed table shows; None shows all."""
    log_x: bool = False
    """Whether the x axis is logarithmic."""
    x_ticks: tuple[float, ...] | None = None
    """The positions of the labels on the x axis; None lets matplotlib choose."""
    x_tick_labels: tuple[str, ...] | None = None
    """The labels of ``x_ticks``; None writes ``x_words`` and numbers."""
    log_y: bool = False
    """Whether the y axis is logarithmic."""
    x_range: tuple[float, float] | None = None
    """The limits of the x axis; None fits the data."""
    y_range: tuple[float, float] | None = None
    """The limits of the y axis; None fits the data."""
    x_words: Mapping[float, str] = field(default_factory=dict)
    """What the table shows in place of an x coordinate that only numbers a quantity."""
    y_marks: Mapping[str, float] = field(default_factory=dict)
    """The y coordinates of dashed lines, each by its text."""

    @property
    def number(self) -> str:
        """The number in the book: ``"10.4"``."""
        return self.name.partition("-")[2]

    @property
    def heading(self) -> str:
        """The number and the title: ``"Figure 10.4: ..."``."""
        return f"{self.name.replace('-', ' ').capitalize()}: {self.title}"

    def conditions(self, counts: Collection[int], runs: int, seed: int) -> str:
        """Describes in words how a result was computed.

        Args:
            counts: The number of runs of each line.
            runs: The requested number of runs.
            seed: The seed of the first run.
        """
        several = sorted(set(counts))
        text = f"{' or '.join(f'{count:,}' for count in several)} {'run' if several == [1] else 'runs'} of each setting"
        if runs != self.runs:
            text += f" ({'FEWER' if runs < self.runs else 'more'} than the {self.runs:,} of the full figure)"
        return f"{text}, seeds from {seed}"

    def __repr__(self) -> str:
        """Returns one line: the number and the title."""
        return f"<{type(self).__name__} {self.heading}>"
