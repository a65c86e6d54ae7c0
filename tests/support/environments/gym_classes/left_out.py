"""Classes with calls whose results are not used, or not always; the comment ``# here`` marks the line."""

import numpy as np

from support.environments.gym_classes.walk import Base


class Moves(Base):
    def move(self):
        self.x = self.x + 1.0
        return self.x > 3.0

    def array(self):
        self.x = self.x + 1.0
        return np.zeros(2)

    def nothing(self):
        self.x = self.x + 1.0


class ElementOfList(Moves):
    def change(self, action):
        return float([self.move(), self.move()][0])  # here


class PartOfTuple(Moves):
    def change(self, action):
        return (self.move(), self.move(), 5.0)[1:][1]  # here


class AnyOfList(Moves):
    def change(self, action):
        return float(any([self.x > 2.0, self.move()]))  # here


class AllOfTuple(Moves):
    def change(self, action):
        return float(all((self.x > 2.0, self.move())))  # here


class AnyOfGeneratorOverCalls(Moves):
    def change(self, action):
        return float(any(one for one in (self.move(), self.move())))  # here


class LengthOfTuple(Moves):
    def change(self, action):
        return float(len((self.move(), self.move())))  # here


class LengthOfArray(Moves):
    def change(self, action):
        return float(len(self.array()))  # here


class SizeOfArray(Moves):
    def change(self, action):
        return float(self.array().size)  # here


class Unpaired(Moves):
    def change(self, action):
        return float(len([one for one, _ in zip((self.move(), self.move()), (1.0,), strict=False)]))  # here


class Reversed(Moves):
    def change(self, action):
        first, _ = reversed((self.move(), self.x > 2.0))  # here
        return float(first)


class IsNone(Moves):
    def change(self, action):
        return 1.0 if self.move() is None else 0.0  # here


class NothingIsNone(Moves):
    def change(self, action):
        return 1.0 if self.nothing() is None else 0.0  # here


class NothingInCondition(Moves):
    def change(self, action):
        self.x > 2.0 and self.nothing()  # here
        return 0.0


class TestsType(Moves):
    def count(self):
        self.x = self.x + 1.0
        return int(self.x)

    def change(self, action):
        return float(isinstance(self.count(), (int, np.integer)))  # here


class NamedArguments(Moves):
    def weighted(self, one, other):
        return 2.0 * one + other

    def change(self, action):
        return self.weighted(other=float(self.move()), one=self.x)  # here


class Assigned(Moves):
    """What the messages advise."""

    def change(self, action):
        first, second = self.move(), self.move()
        self.nothing()
        values = self.array()
        made = np.array([float(self.move()), self.np_random.random()], dtype=np.float64)
        return float(any([first, second])) + float([second, first][0]) + len(values) + made[0] + made[1]


class ShortCircuits(Moves):
    """A generator expression stops where compiled code does."""

    def change(self, action):
        return float(any(self.move() for _ in range(3))) + float(self.x > 9.0 or self.move())


class KeepsInDict(Moves):
    """A dict of values that change, with its keys."""

    def change(self, action):
        found = {"first": self.move(), "second": self.x, 3: self.array()}
        return float(found["first"]) + found["second"] + found[3][1] + len(found)
