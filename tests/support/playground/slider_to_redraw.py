"""How long the playground takes from a move of a slider to the redrawn page.

``python tests/support/playground/slider_to_redraw.py`` trains 5,000 episodes of the article for each of 15 learning
rates, in Chromium without a graphics card, and prints medians and ranges by the page's own clock. With the name of an
algorithm, as in ``python tests/support/playground/slider_to_redraw.py sarsa``, it trains a second agent beside the
first one. Nothing else should run meanwhile.
"""

import os
import statistics
import sys
import tempfile
from pathlib import Path

import qtab.playground

CHANGES = 15

PREPARE = """() => {
  const { training, view } = globalThis.playground;
  const times = globalThis.times = {};
  const { onResult } = training;
  training.onResult = (message) => {
    if (message.type === "result" && message.state === "finished") {
      times.arrived = performance.now();
      times.training = message.seconds * 1000;
    }
    onResult(message);
  };
  const draw = view.draw.bind(view);
  view.draw = () => {
    draw();
    if (view.result.state !== "finished" || (view.names.length && view.otherResult?.state !== "finished")) return;
    times.drawn = performance.now();
    // The frame is on its way to the screen when the next one begins.
    requestAnimationFrame(() => requestAnimationFrame(() => { times.shown = performance.now(); }));
  };
}"""

MOVE = """(value) => new Promise((resolve) => {
  const { times } = globalThis;
  const slider = document.querySelector("#slide-learning_rate");
  times.shown = null;
  slider.value = value;
  const moved = performance.now();
  slider.dispatchEvent(new Event("input", { bubbles: true }));
  const look = () => {
    if (times.shown === null) setTimeout(look, 20);
    else resolve([times.training, times.arrived - moved, times.drawn - moved, times.shown - moved]);
  };
  look();
})"""


def measured() -> list[list[float]]:
    """Returns the milliseconds of each change: of training; and until the result arrived, was drawn, and was shown."""
    from playwright.sync_api import sync_playwright

    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        file = Path(folder) / "playground.html"
        file.write_text(qtab.playground.page(), encoding="utf-8")
        program = os.environ.get("CHROMIUM", "/usr/bin/chromium")
        browser = playwright.chromium.launch(executable_path=program, args=["--no-sandbox"])
        page = browser.new_page(viewport={"width": 1280, "height": 900})
        compared = f"#compare={sys.argv[1]}" if len(sys.argv) > 1 else ""
        page.goto(file.as_uri() + compared)
        page.wait_for_function("() => globalThis.playground?.training.state === 'finished'")
        page.evaluate(PREPARE)
        changes: list[list[float]] = []
        for index in range(CHANGES):
            page.wait_for_timeout(1000)
            changes.append(page.evaluate(MOVE, str(100 + 20 * index)))
        browser.close()
    return changes


if __name__ == "__main__":
    names = ("training alone", "until the result arrived", "until it was drawn", "until it was shown")
    for name, times in zip(names, zip(*measured(), strict=True), strict=True):
        median = f"{statistics.median(times):4.0f}"
        sys.stdout.write(f"{name:25s} median {median} ms, from {min(times):.0f} to {max(times):.0f} ms\n")
