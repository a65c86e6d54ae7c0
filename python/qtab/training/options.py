"""The arguments of ``train`` that are not settings of the run; none of them changes a result."""

from collections.abc import Sequence
from dataclasses import dataclass

from qtab._utils import checks
from qtab._utils.memory import memory_limit as bytes_limit
from qtab.training.callbacks import CallbackList, Callbacks

CALLBACK_EVERY = 100


@dataclass(frozen=True)
class TrainingOptions:
    """The arguments of :func:`qtab.train` and :func:`qtab.resume` that are not settings, checked.

    Raises:
        TypeError: for an argument of the wrong type.
        ValueError: for an argument out of range.
    """

    callback: Callbacks | None = None
    callback_every: int = CALLBACK_EVERY
    record: int = 0
    visits: bool = False
    snapshots: int | Sequence[int] | None = None
    """Checked once the number of episodes is known."""
    progress: bool | None = None
    memory_limit: int | None = None

    def __post_init__(self) -> None:
        """Checks the arguments before the environment is made."""
        checks.integer("callback_every", self.callback_every, least=1)
        checks.count("record", self.record, least=0)
        checks.boolean("visits", self.visits)
        bytes_limit(self.memory_limit)
        self.callbacks()

    def callbacks(self) -> CallbackList:
        """Returns the callbacks as one callback."""
        return CallbackList(self.callback, int(self.callback_every))
