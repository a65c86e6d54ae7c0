"""``qtab.Diagnosis``: the findings of the checks, and the changes that they advise."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from qtab._utils import html
from qtab._utils.shown import counted, last_of
from qtab.diagnosis.facts import Facts
from qtab.diagnosis.finding import COLUMNS, Finding
from qtab.diagnosis.what_if import WhatIf, try_changes
from qtab.results.run import Run
from qtab.training.verdict import Verdict

SEEDS = 20


@dataclass(frozen=True, eq=False, repr=False)
class Diagnosis:
    """Reasons why a run did not solve its environment: findings with evidence and advice. It prints as text."""

    run: Run
    """The run."""
    solved: bool | None
    """Whether the run solved its environment; None if neither threshold nor optimum is known."""
    findings: tuple[Finding, ...]
    """The findings, the most direct first."""
    unremarkable: tuple[str, ...]
    """The checks that found nothing."""
    not_made: tuple[str, ...]
    """The checks that could not be made, such as those that repeat the run if Rust does not step the environment."""
    reasons: Mapping[str, str]
    """The reason why each check of ``not_made`` could not be made."""
    facts: Facts = field(repr=False)
    """The run and the facts computed from it."""
    seconds: float = field(repr=False)
    """The wall-clock time of the diagnosis."""

    def __repr__(self) -> str:
        """Returns the whole report, so that interactive Python shows it."""
        return str(self)

    def __str__(self) -> str:
        lines = [self.heading]
        lines += [f"\n{number}. {finding}" for number, finding in enumerate(self.findings, 1)]
        return "\n".join([*lines, *(f"\n{line}" for line in self._footer())])

    def _repr_html_(self) -> str:
        """HTML for notebooks: the findings as a table."""
        rows = [finding.cells() for finding in self.findings]
        return html.sentences(self.heading, COLUMNS, rows, self._footer())

    def __len__(self) -> int:
        return len(self.findings)

    def __iter__(self) -> Iterator[Finding]:
        return iter(self.findings)

    def __getitem__(self, name: str) -> Finding:
        """Returns a finding by its name.

        Raises:
            KeyError: if there is none.
        """
        for finding in self.findings:
            if finding.name == name:
                return finding
        raise KeyError(f"no finding {name!r}; there are {', '.join(self.names) or 'none'}")

    def __contains__(self, name: object) -> bool:
        return name in self.names

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the findings."""
        return tuple(finding.name for finding in self.findings)

    @property
    def heading(self) -> str:
        """The run and whether it solved its environment, in one line."""
        word = {True: "solved", False: "not solved", None: "not known whether solved"}[self.solved]
        return f"Diagnosis of the run {repr(self.run)[1:-1].removeprefix('Run ')}: {word}"

    @property
    def verdict(self) -> Verdict:
        """Whether the run solved its environment, with the measured returns."""
        return self.facts.verdict

    def what_if(self, seeds: "int | Iterable[int]" = SEEDS, *, progress: bool | None = None) -> WhatIf:
        """Tries the advised changes, one at a time, over the same seeds, and compares each with the run's settings.

        Args:
            seeds: The seeds, at least two, as for :func:`qtab.train_many`.
            progress: Whether to show a progress bar over all runs. None shows one on a terminal or in a notebook if
                they take more than a second.

        Raises:
            ModuleNotFoundError: if SciPy, which the intervals need, is not installed.
            ValueError: for fewer than two seeds, if no finding advises a change, or if the run's environment cannot be
                made from its id.
        """
        return try_changes(self.facts, self.findings, seeds, progress)

    def _footer(self) -> list[str]:
        lines = []
        if self.solved:
            lines.append(f"Solved: {self.verdict}.")
        elif self.solved is None:
            lines += [self._returns()] if self.facts.greedy is not None else []
            lines.append(f"It is not known whether the run solved its environment: {self.verdict.why_unknown}.")
        if not self.findings:
            lines.append("There is nothing to advise." if self.solved else "No check found anything to advise.")
        elif self.unremarkable:
            lines.append(f"Nothing to report on: {', '.join(self.unremarkable)}.")
        if self.reasons:
            lines.append("\n".join(self._not_checked()))
        return lines

    def _returns(self) -> str:
        """The mean returns of the greedy policy and of training, in a sentence."""
        played, verdict = self.facts.greedy, self.verdict
        if played is None:
            return ""
        greedy = counted(len(played.returns), "greedy episode")
        last = last_of(verdict.last, "training episode")
        return f"Mean returns: {played.returns.mean():.4g} in {greedy}, {verdict.final_return:.4g} in the {last}."

    def _not_checked(self) -> Iterator[str]:
        for reason in dict.fromkeys(self.reasons.values()):
            names = [name for name in self.not_made if self.reasons[name] == reason]
            yield f"Not checked, as {reason}: {', '.join(names)}."
