"""Evaluates printed equations: each number stands for all numbers that are printed like it."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass

DIGITS = 6
"""The significant digits of a printed number."""
TOKEN = re.compile(r"\s*((?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?|[-+·^()\[\]])")
SIGNS = "-+·^()[]"
SLACK = 1e-12
"""The relative error of the operations themselves."""


class NotNumericError(ValueError):
    """A text that is no expression of numbers."""


@dataclass(frozen=True)
class Interval:
    """The numbers from ``low`` to ``high``."""

    low: float
    high: float

    def __add__(self, other: "Interval") -> "Interval":
        return Interval(self.low + other.low, self.high + other.high)

    def __neg__(self) -> "Interval":
        return Interval(-self.high, -self.low)

    def __mul__(self, other: "Interval") -> "Interval":
        products = [one * another for one in (self.low, self.high) for another in (other.low, other.high)]
        return Interval(min(products), max(products))

    def meets(self, other: "Interval") -> bool:
        """Whether the two have a number in common, apart from the errors of the operations."""
        ends = (self.low, self.high, other.low, other.high)
        room = SLACK * max(1.0, *map(abs, ends))
        return all(map(math.isfinite, ends)) and self.low - room <= other.high and other.low - room <= self.high


def printed(text: str) -> Interval:
    """Returns the numbers that are printed like a text without a sign."""
    value = float(text)
    half = 0.0 if value == 0.0 else 0.5 * 10.0 ** (math.floor(math.log10(value)) - DIGITS + 1)
    return Interval(value - half, value + half)


def evaluated(text: str, names: Mapping[str, float] | None = None) -> Interval:
    """Returns the value of an expression: sums, differences, products, powers and two kinds of parentheses.

    Args:
        text: The expression.
        names: The exact values of names in it, which are multiplied where they stand beside each other.

    Raises:
        NotNumericError: if it is not such an expression.
    """
    return _Parser(text, names or {}).value()


def sides(text: str) -> list[str]:
    """Returns the sides of an equation that are expressions of numbers."""
    found = []
    for side in re.split(r"\s(?:=|<-)\s", text):
        try:
            evaluated(side)
        except NotNumericError:
            continue
        found.append(side)
    return found


def check_equations(text: str) -> int:
    """Compares the sides of every equation in a text, and returns the number of equations that have two."""
    checked = 0
    for line in text.splitlines():
        for part in re.split(r"[,;]\s", line):
            first, *others = sides(part) or [""]
            checked += bool(others)
            for other in others:
                assert evaluated(first).meets(evaluated(other)), f"{part.strip()}: the sides differ"
    return checked


def check_symbols(equation: str, names: Mapping[str, float], result: float) -> None:
    """Compares the right side of an equation in symbols with its result."""
    _, right = re.split(r"\s(?:=|<-)\s", equation) if re.search(r"\s(?:=|<-)\s", equation) else ("", equation)
    value = evaluated(right, names)
    assert abs(value.low - result) <= 1e-9 * max(1.0, abs(result)), f"{equation} is {value.low}, not {result}"


class _Parser:
    """Takes an expression apart from left to right."""

    def __init__(self, text: str, names: Mapping[str, float]) -> None:
        self.text, self.names = text.strip(), names
        self.tokens: list[str] = []
        longest_first = sorted(names, key=len, reverse=True)
        position = 0
        while position < len(self.text):
            name = next((name for name in longest_first if self.text.startswith(name, position)), None)
            match = TOKEN.match(self.text, position)
            if name is not None:
                self.tokens.append(name)
                position += len(name)
            elif self.text[position] == " ":
                position += 1
            elif match is not None:
                self.tokens.append(match.group(1))
                position = match.end()
            else:
                raise NotNumericError(text)

    def value(self) -> Interval:
        value = self._sum()
        if self.tokens:
            raise NotNumericError(self.text)
        return value

    def _next(self) -> str:
        return self.tokens[0] if self.tokens else ""

    def _sum(self) -> Interval:
        value = self._product()
        while self._next() in ("+", "-"):
            sign, other = self.tokens.pop(0), self._product()
            value = value + (other if sign == "+" else -other)
        return value

    def _product(self) -> Interval:
        value = self._power()
        while self._next() == "·" or (self.names and self._next() not in ("", "+", "-", ")", "]")):
            if self._next() == "·":
                self.tokens.pop(0)
            value = value * self._power()
        return value

    def _power(self) -> Interval:
        value = base = self._atom()
        if self._next() == "^":
            self.tokens.pop(0)
            if not self._next().isdigit():
                raise NotNumericError(self.text)
            for _ in range(int(self.tokens.pop(0)) - 1):
                value = value * base
        return value

    def _atom(self) -> Interval:
        first = self.tokens.pop(0) if self.tokens else ""
        if first in self.names:
            return Interval(self.names[first], self.names[first])
        if first == "-":
            return -self._atom()
        if first in ("(", "["):
            value = self._sum()
            if not self.tokens or self.tokens.pop(0) != {"(": ")", "[": "]"}[first]:
                raise NotNumericError(self.text)
            return value
        if not first or first in SIGNS:
            raise NotNumericError(self.text)
        return printed(first)
