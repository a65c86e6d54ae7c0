"""The playground in a browser, as its tests see it."""

from pathlib import Path
from typing import Any

PATIENCE = 300_000
"""What a busy machine may take for anything in the browser, in milliseconds."""

SETTLED = """() => {
  const { training, view } = globalThis.playground ?? {};
  const done = ["paused", "finished", "diverged"];
  return view?.result && !view.isStale && !view.waiting && view.result.id === training.id
    && done.includes(training.state) && done.includes(view.result.state)
    && training.inspectedRun === training.id
    && (training.cell === null || view.result.inspection?.cell === training.cell);
}"""
"""Whether the result of the newest choices is drawn, with the numbers of the cell that is inspected after it."""

COLORS = """(canvas) => {
  const data = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data;
  const colors = new Set();
  for (let at = 0; at < data.length; at += 4) {
    if (data[at + 3]) colors.add((data[at] << 16) | (data[at + 1] << 8) | data[at + 2]);
  }
  return colors.size;
}"""
"""How many colors a canvas has."""

RESULT = """() => {
  const { result } = globalThis.playground.view;
  return {
    state: result.state, done: result.done, seeds: result.seeds, returns: Array.from(result.returns),
    lengths: Array.from(result.lengths), columns: result.map.columns, rows: result.map.rows,
    values: Array.from(result.map.values, (value) => Number.isNaN(value) ? null : value),
    visits: Array.from(result.map.visits), greedy: Array.from(result.map.greedy),
  };
}"""


class Playground:
    """The page, what it wrote to the console, and what it asked of the network."""

    def __init__(self, context: Any, file: Path) -> None:
        self.file = file
        self.page = context.new_page()
        self.page.set_default_timeout(PATIENCE)
        self.problems: list[str] = []
        self.requests: list[str] = []
        self.page.on("console", lambda message: self._heard(message.type, message.text))
        self.page.on("pageerror", lambda error: self.problems.append(str(error)))
        self.page.on("request", lambda request: self.requests.append(request.url))

    def _heard(self, kind: str, text: str) -> None:
        if kind in ("error", "warning"):
            self.problems.append(text)

    def open(self, fragment: str = "") -> "Playground":
        """Opens the page anew, at a fragment of its address, and waits for its first result."""
        self.page.goto("about:blank")
        self.page.goto(self.file.as_uri() + fragment)
        return self.settled()

    def settled(self) -> "Playground":
        """Waits until the result of the newest choices is drawn."""
        self.page.wait_for_function(SETTLED, polling=20)
        return self

    def result(self) -> dict[str, Any]:
        """Returns the newest result, with typed arrays as lists and NaN as None."""
        found: dict[str, Any] = self.page.evaluate(RESULT)
        return found

    def state(self) -> dict[str, Any]:
        """Returns what was chosen."""
        found: dict[str, Any] = self.page.evaluate("() => globalThis.playground.store.state")
        return found

    def colors(self, canvas: str) -> int:
        """Returns how many colors a canvas has; several unless it is blank."""
        found: int = self.page.locator(f"#{canvas}").evaluate(COLORS)
        return found

    def type_number(self, setting: str, text: str) -> None:
        """Types a number into the field of a setting, and leaves the field."""
        field = self.page.locator(f"#set-{setting}")
        field.fill(text)
        field.press("Enter")

    def text(self, element: str) -> str:
        """Returns the visible text of an element."""
        found: str = self.page.locator(f"#{element}").inner_text()
        return found
