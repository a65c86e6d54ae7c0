// The lines to compare the learning curve with, and their key.

import { windowOf } from "./statistics.js";
import { counted } from "./format.js";

/** The expected return of the best or, for the environment's default time limit, best known policy; null if unknown. */
export function bestReturn(entry, settings, best) {
  return best?.return ?? (hasOwnLimit(entry, settings) ? entry.best_known : null);
}

/** Whether a run has the time limit that the environment's threshold assumes. */
function hasOwnLimit(entry, settings) {
  return settings.max_episode_steps === entry.max_episode_steps;
}

/** The threshold and the optimum as lines of the learning curve, and the key below it. */
export class Marks {
  constructor(list) {
    this.list = list;
    this.shown = "";
  }

  /** The lines to compare with, as {value, name, dash}. */
  of({ entry, state: { settings } }, { best }) {
    const marks = [];
    if (entry.threshold !== null && hasOwnLimit(entry, settings)) marks.push({ name: "threshold", value: entry.threshold, dash: [2, 4] });
    const value = bestReturn(entry, settings, best);
    if (value !== null) marks.push({ name: best?.kind ?? "best known", value, dash: [8, 5] });
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
    if (best) lines.push(["good", "2px dashed", best.name === "optimal" ? "greatest expected return" : "best known return"]);
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
