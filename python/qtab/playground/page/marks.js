// What the learning curve is compared with, and the key of its lines.

import { windowOf } from "./statistics.js";
import { counted } from "./format.js";

/** The threshold and the optimum as lines of the learning curve, and the key below it. */
export class Marks {
  constructor(list) {
    this.list = list;
    this.shown = "";
  }

  /** {name, value, dash} of each line to compare with. */
  of({ entry }, { best }) {
    const marks = [];
    if (entry.threshold !== null) marks.push({ name: "threshold", value: entry.threshold, dash: [2, 4] });
    if (best && best.return !== null) marks.push({ name: best.kind, value: best.return, dash: [8, 5] });
    else if (entry.best_known !== null) marks.push({ name: "best known", value: entry.best_known, dash: [8, 5] });
    return marks;
  }

  showKey(seeds, episodes, marks, word) {
    const width = counted(windowOf(episodes), "episode");
    const mean = `mean of ${width}`;
    const lines =
      seeds > 1
        ? [["accent", "1px solid", `each seed, ${mean}`], ["warm", "3px solid", `mean of ${seeds} seeds, with its 95 % interval`]]
        : [["accent", "3px dotted", `${word} of each episode`], ["warm", "3px solid", mean]];
    if (marks.some(({ name }) => name === "threshold")) lines.push(["good", "2px dotted", "threshold of a solved task"]);
    const best = marks.find(({ name }) => name !== "threshold");
    if (best) lines.push(["good", "2px dashed", best.name === "optimal" ? "expected return of an optimal policy" : "best known return"]);
    const shown = JSON.stringify(lines);
    if (shown === this.shown) return;
    this.shown = shown;
    this.list.replaceChildren(
      ...lines.map(([color, stroke, text]) => {
        const item = Object.assign(document.createElement("li"), { textContent: text });
        item.style.setProperty("--color", `var(--${color})`);
        item.style.setProperty("--stroke", stroke);
        return item;
      }),
    );
  }
}
