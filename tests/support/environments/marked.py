"""The line of a class that is marked."""

import inspect
import re


def marked_line(cls: type) -> int:
    """Returns the number of the only line of a class whose comment has the word "here"."""
    lines, first = inspect.getsourcelines(cls)
    (marked,) = [number for number, line in enumerate(lines, first) if re.search(r"#.*\bhere\b", line)]
    return marked
