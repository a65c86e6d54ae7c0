"""Functions that only info dicts call are left out, unless they change what they have not made."""

import enum
from typing import Any

import numpy as np
import pytest

from qtab.compilation.not_compilable import NotCompilable
from qtab.compilation.rewriting import rewrite
from support.environments.gym_classes.extra import ExtraEnv

TOTALS: dict[str, Any] = {"steps": 0, "cells": []}


def change(value):
    TOTALS["cells"].append(value)
    return 1


class Counted(enum.Enum):
    """Has no member yet."""

    @classmethod
    def _missing_(cls, value):
        TOTALS["steps"] += 1
        return next(iter(cls))


class Kind(Counted):
    """Finds a member by code of its base class."""

    ONE = 1


class Shows(ExtraEnv):
    """Has an info dict that a method computes."""

    def reset(self, *, seed=None, options=None):
        self.board = np.zeros(3)
        return super().reset(seed=seed)

    def step(self, action):
        if action:
            self.board[1] = 1.0
        return self.cell, float(self.board[0]), False, False, self.shown()

    def made(self):
        return {"cell": self.cell}

    def shown(self) -> Any:
        """Changes only what it makes."""
        info, cells, counts, after = self.made(), [], np.zeros(3), self.cell
        info["board"] = self.board.copy()
        info.update(cell=1)
        cells.append(self.cell)
        cells += [1]
        counts[0] = 1.0
        counts += 1.0
        after += 1
        total = len(cells) if self.cell else 0
        total += max(counts.sum(), np.clip(after, 0, 3), key=abs)
        text = f"{total}"
        text += "!"
        more = after
        more -= getattr(self, "cell", 0)
        with np.errstate(all="ignore"):
            info["more"] = sorted([more, after], key=self.sign)
        return info

    def sign(self, value):
        return -value


class ChangesElement(Shows):
    def shown(self):
        board = self.board
        board[0] += 1.0
        return {}


class ChangesArray(Shows):
    def shown(self):
        board = self.board
        board += 1.0
        return {}


class ChangesDict(Shows):
    def shown(self):
        totals = TOTALS
        totals["steps"] += 1
        return {}


class Appends(Shows):
    def shown(self):
        cells = TOTALS["cells"]
        cells.append(self.cell)
        return {}


class ChangesInner(Shows):
    def shown(self):
        kept = [self.board]
        kept[0][0] = 1.0
        return {}


class ChangesInLoop(Shows):
    def shown(self):
        for cells in [TOTALS["cells"]]:
            cells.append(self.cell)
        return {}


class ChangesPositional(Shows):
    def changed(self, cells, /):
        if self.cell > 20:
            cells = []
        cells.append(self.cell)
        return {}

    def shown(self):
        return self.changed(TOTALS["cells"])


class ReadsProperty(Shows):
    @property
    def count(self):
        TOTALS["cells"].append(self.cell)
        return 1

    def shown(self, /):
        return {"count": self.count}


class ChangesInnerInPlace(Shows):
    def shown(self):
        made = {"board": self.board}
        made["board"] += 1.0
        return made


class ChangesWhatItChose(Shows):
    def shown(self):
        board = self.board if self.cell else None or self.board
        board += 1.0
        return {}


class ChangesWhatItTakes(Shows):
    def shown(self):
        made = {"board": self.board}
        board = made["board"]
        board += 1.0
        return {}


class ChangesResult(Shows):
    def kept(self):
        return self.board, []

    def shown(self):
        board, _ = self.kept()
        board += 1.0
        return {}


class ChangesFirst(Shows):
    def shown(self):
        made = [TOTALS["cells"]]
        cells, *_ = made
        cells += [self.cell]
        return {}


class ChangesView(Shows):
    def shown(self):
        board = self.board.ravel()
        board += 1.0
        return {}


class CallsForEach(Shows):
    def shown(self):
        return {"cells": list(map(TOTALS["cells"].append, [self.cell]))}


class CallsForKey(Shows):
    def change(self, cell):
        self.board[0] += 1.0
        return cell

    def shown(self):
        return {"cell": max([1, 2], key=self.change)}


class CallsOfModule(Shows):
    def shown(self):
        function = change
        return {"cells": sum(map(function, [self.cell]))}


class ComputesProperty(ReadsProperty):
    def shown(self, /):
        return {"count": getattr(self, "count", 0)}


class ChangesArgument(Shows):
    def shown(self):
        return {"sum": np.add(self.board, 1.0, self.board)}


class ChangesOut(Shows):
    def shown(self):
        return {"clipped": np.clip(self.board, 0.0, 1.0, out=self.board)}


class ReplacesNaN(Shows):
    def shown(self):
        return {"board": np.nan_to_num(self.board, copy=False)}


class HidesOut(Shows):
    def shown(self):
        arguments = (self.board, 1.0, self.board)
        return {"sum": np.add(*arguments)}


class ChangesThird(Shows):
    def shown(self):
        return {"joined": np.concatenate([self.board], 0, self.board)}


class Copies(Shows):
    def shown(self):
        np.copyto(self.board, 1.0)
        return {}


class Decorates(Shows):
    def shown(self):
        @change
        def nothing():
            pass

        return {}


class Finds(Shows):
    def shown(self):
        return {"kind": Kind(self.cell)}


class PopsInStep(ExtraEnv):
    def step(self, action):
        values = [0, 1]
        info = {"last": values.pop()}
        return self.cell, float(len(values)), False, False, info


CHANGES = [
    *(ChangesElement, ChangesArray, ChangesDict, Appends, ChangesInner, ChangesInLoop),
    *(ChangesPositional, ReadsProperty, Finds, PopsInStep, ChangesInnerInPlace, ChangesWhatItChose, ChangesWhatItTakes),
    *(ChangesResult, ChangesFirst, ChangesView, CallsForEach, CallsForKey, CallsOfModule, ComputesProperty),
    *(ChangesArgument, ChangesOut, ReplacesNaN, HidesOut, ChangesThird, Copies, Decorates),
]


@pytest.mark.parametrize("cls", CHANGES, ids=lambda cls: cls.__name__)
def test_changes_of_what_a_function_has_not_made_are_refused(cls: Any) -> None:
    with pytest.raises(NotCompilable, match="left out in compiled code, but"):
        rewrite(cls())
    assert TOTALS == {"steps": 0, "cells": []}


def test_changes_of_what_a_function_makes_are_left_out() -> None:
    assert rewrite(Shows()).source
