"""What an experiment is called, where it comes from, and how its table and figure are laid out."""

from dataclasses import dataclass

MAX_EPISODE_STEPS = 5_000
"""The time limit of an experiment that does not set another one."""


@dataclass(frozen=True, kw_only=True, repr=False)
class Description:
    """An experiment in words, with the layout of its table and figure."""

    name: str
    """Its kind and its number in the book: ``"figure-10.4"``."""
    title: str
    book: str
    """The settings that the book states."""
    unspecified: str
    """What the book does not state, and what is used here."""
    runs: int
    """The number of runs of each setting, as in the book."""
    x_label: str
    y_label: str
    table_x: tuple[float, ...] | None = None
    """The points that the printed table shows; None shows all."""
    max_episode_steps: int = MAX_EPISODE_STEPS
    """Episodes are truncated after this many steps. The book has no time limit."""
    log_y: bool = False
    """Whether the y axis is logarithmic."""
    x_range: tuple[float, float] | None = None
    """The limits of the x axis; None fits the data."""
    y_range: tuple[float, float] | None = None
    """The limits of the y axis; None fits the data."""

    @property
    def number(self) -> str:
        """The number in the book: ``"10.4"``."""
        return self.name.partition("-")[2]

    @property
    def heading(self) -> str:
        """``"Figure 10.4: ..."``."""
        return f"{self.name.replace('-', ' ').capitalize()}: {self.title}"

    def __repr__(self) -> str:
        """One line."""
        return f"<{type(self).__name__} {self.heading}>"
