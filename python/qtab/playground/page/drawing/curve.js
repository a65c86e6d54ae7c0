// The learning curve: the return of each episode, its moving mean, and the lines to compare it with.

import { disc, line, polygon } from "./shapes.js";
import { axes, onResize, scale, surface, ticks } from "./surface.js";
import { onThemeChange, themeColors } from "./theme.js";
import { make } from "../controls/elements.js";
import { count, counted, number } from "../format.js";
import { lastOf, meanAndInterval, movingMeans, quantile, windowEnds, windowOf } from "../results/statistics.js";

const POINTS = 400;
const MAX_DOTS = 6000;

/** The end of the axis of episodes: that of the run, or of its beginning as long as only that is finished. */
function axisEnd(finished, episodes) {
  const power = 10 ** Math.floor(Math.log10(Math.max(finished, 1)));
  const end = [1, 2, 3, 5, 10].map((factor) => factor * power).find((each) => each >= finished);
  return Math.min(end, episodes);
}

/** Shows learning curves on a canvas, with a summary below and the numbers under the pointer. */
export class LearningCurve {
  constructor(canvas, summary) {
    this.canvas = canvas;
    this.summary = summary;
    this.shown = null;
    this.pointer = null;
    onResize([canvas], () => this.draw());
    onThemeChange(() => this.draw());
    canvas.addEventListener("pointermove", (event) => this.point(event.offsetX));
    canvas.addEventListener("pointerleave", () => this.point(null));
  }

  /**
   * Shows a number for each episode: `returns` has an array for each seed. `episodes`: the length of the run; `marks`:
   * {value, name} to compare with; `measure`: "returns", or "lengths" for the numbers of steps; `names`: those of the
   * agent and of the other one, and `others` the numbers of that, if two are compared.
   */
  show(returns, episodes, marks, measure = "returns", { names = [], others = null } = {}) {
    const width = windowOf(episodes);
    const word = measure === "lengths" ? "number of steps" : "return";
    const other = others && movingMeansOf(others, width, lastOf(episodes));
    this.shown = { ...movingMeansOf(returns, width, lastOf(episodes)), episodes, marks, word, names, other };
    this.describe();
    this.draw();
  }

  describe() {
    const { returns, episodes, marks, word, finished, covered, atEnds, names, other } = this.shown;
    const seeds = returns.length;
    if (!finished) {
      this.canvas.setAttribute("aria-label", "Learning curve: no episode is finished yet.");
      this.summary.textContent = "No episode is finished yet.";
      return;
    }
    const [first, last] = atEnds.mean.map((mean) => number(mean));
    const half = ({ half: [, end] }) => (seeds > 1 ? ` ± ${number(end, 3)}` : "");
    const interval = seeds > 1 ? ` (95 % interval of the mean of ${seeds} seeds)` : "";
    const compared = other?.finished ? `; ${names[1]}: ${number(other.atEnds.mean[1])}${half(other.atEnds)}` : "";
    const lucky = compared && seeds === 1 ? " One seed can be lucky: compare over 16 seeds." : "";
    const name = compared ? `${names[0]}: ` : "";
    this.summary.textContent = `Mean ${word} of the last ${counted(covered, "episode")}: ${name}${last}${half(atEnds)}${compared}${interval}.${lucky}`;
    this.canvas.setAttribute(
      "aria-label",
      `Learning curve of ${count(finished)} of ${counted(episodes, "episode")}, ${counted(seeds, "seed")}. ` +
        `Mean ${word} at first ${first}, at last ${name}${last}${compared}. ` +
        marks.map(({ name, value }) => `${name}: ${number(value)}.`).join(" "),
    );
  }

  point(x) {
    this.pointer = x;
    if (this.shown) this.draw();
  }

  /** The range of returns to show. Rare, very low returns, such as those of early falls from a cliff, are cut off. */
  range() {
    const { marks, other } = this.shown;
    const drawn = marks.map(({ value }) => value);
    for (const { returns, over, means } of [this.shown, ...(other ? [other] : [])]) {
      const lowest = Math.min(...returns.map((each) => quantile(each, 0.03)));
      drawn.push(...(returns.length === 1 ? [lowest] : means.map((each) => quantile(each, 0.03))));
      for (const value of over.mean) if (Number.isFinite(value) && value >= lowest) drawn.push(value);
      drawn.push(...returns.map((each) => quantile(each, 0.999)));
    }
    const finite = drawn.filter(Number.isFinite);
    if (!finite.length) return [0, 1];
    const low = Math.min(...finite);
    const high = Math.max(...finite);
    const margin = (high - low || Math.abs(high) || 1) * 0.06;
    return [low - margin, high + margin];
  }

  draw() {
    if (!this.shown) return;
    const { g, width, height } = surface(this.canvas);
    const { episodes, finished, marks, other } = this.shown;
    const [low, high] = this.range();
    const box = { left: 52, right: width - 14, top: 22, bottom: height - 42 };
    const end = (this.shown.end = axisEnd(Math.max(finished, other?.finished ?? 0), episodes));
    const x = scale(0, end, box.left, box.right);
    const y = scale(low, high, box.bottom, box.top);
    axes(g, box, x, y, ticks(0, end, width < 420 ? 4 : 5).filter(Number.isInteger), ticks(low, high, 6), { x: "episode", y: this.shown.word });
    g.save();
    g.beginPath();
    g.rect(box.left, box.top - 4, box.right - box.left, box.bottom - box.top + 8);
    g.clip();
    const colors = themeColors();
    // Of two agents, each has its own color; of one, the episodes and their mean have.
    if (other) {
      drawAgent(g, other, x, y, { single: colors.second, mean: colors.second, seeds: null });
      drawAgent(g, this.shown, x, y, { single: colors.warm, mean: colors.warm, seeds: null });
    } else {
      drawAgent(g, this.shown, x, y, { single: colors.accent, mean: colors.warm, seeds: colors.accent });
    }
    g.restore();
    drawMarks(g, box, marks, y, colors);
    this.drawPointer(g, box, x, y, colors);
  }

  drawPointer(g, box, x, y, colors) {
    const { ends, over, names, other } = this.shown;
    if (this.pointer === null || !ends.length || this.pointer < box.left) return;
    const index = ends.findIndex((end) => x(end) >= this.pointer);
    const at = index < 0 ? ends.length - 1 : index;
    const left = x(ends[at]);
    line(g, [[left, box.top], [left, box.bottom]], colors.muted, 1);
    disc(g, left, y(over.mean[at]), 4, colors.warm);
    const beside = other?.ends[at] === ends[at] ? `, ${names[1]} ${number(other.over.mean[at])}` : "";
    if (beside) disc(g, left, y(other.over.mean[at]), 4, colors.second);
    const label = `episode ${count(ends[at])}: ${beside ? `${names[0]} ` : ""}${number(over.mean[at])}${beside}`;
    const wide = g.measureText(label).width;
    const from = left > (box.left + box.right) / 2 ? left - 8 - wide : left + 8;
    g.fillStyle = colors.card;
    g.globalAlpha = 0.9;
    g.fillRect(from - 4, box.bottom - 24, wide + 8, 18);
    g.globalAlpha = 1;
    g.fillStyle = colors.ink;
    g.textAlign = "left";
    g.fillText(label, from, box.bottom - 15);
  }
}

/**
 * Moving means of the numbers of each seed, and their mean and interval over the seeds. `atEnds` has those of the first
 * and of the last `covered` episodes: `most`, or all that are finished.
 */
function movingMeansOf(returns, width, most) {
  const finished = Math.min(...returns.map((each) => each.length));
  const ends = windowEnds(finished, POINTS);
  const means = returns.map((each) => movingMeans(each, width, ends));
  const over = finished ? meanAndInterval(means) : { mean: [], half: [] };
  const covered = Math.min(most, finished);
  const atEnds = meanAndInterval(returns.map((each) => movingMeans(each, covered, [covered, finished])));
  return { returns, finished, ends, means, over, covered, atEnds };
}

/** Draws the curve of an agent: with the numbers of its episodes for one seed, and with the interval for several. */
function drawAgent(g, { returns, means, over, ends }, x, y, { single, mean, seeds }) {
  const points = (values) => values.map((value, index) => [x(ends[index]), y(value)]);
  if (returns.length === 1) drawDots(g, returns[0], x, y, single);
  else {
    g.globalAlpha = 0.28;
    if (seeds) for (const each of means) line(g, points(each), seeds, 1);
    const upper = points(over.mean.map((value, index) => value + over.half[index]));
    const lower = points(over.mean.map((value, index) => value - over.half[index]));
    g.globalAlpha = 0.22;
    polygon(g, [...upper, ...lower.reverse()], mean);
    g.globalAlpha = 1;
  }
  line(g, points(over.mean), mean, 2.5);
}

function drawDots(g, returns, x, y, color) {
  const step = Math.max(returns.length / MAX_DOTS, 1);
  const size = returns.length > 1500 ? 1.6 : returns.length > 300 ? 2.4 : 3.4;
  g.fillStyle = color;
  g.globalAlpha = returns.length > 1500 ? 0.3 : 0.5;
  for (let place = 0; place < returns.length; place += step) {
    const index = Math.floor(place);
    g.fillRect(x(index + 1) - size / 2, y(returns[index]) - size / 2, size, size);
  }
  g.globalAlpha = 1;
}

/** Draws the lines to compare with, which the key below the curve names. */
function drawMarks(g, box, marks, y, colors) {
  for (const { value, dash } of marks.filter((mark) => Number.isFinite(mark.value))) {
    g.setLineDash(dash);
    line(g, [[box.left, y(value)], [box.right, y(value)]], colors.good, 1.5);
  }
  g.setLineDash([]);
}

/** The expected return of the best or, for the environment's default time limit, best known policy; null if unknown. */
export function bestReturn(entry, settings, best) {
  return best?.return ?? (hasOwnLimit(entry, settings) ? entry.best_known : null);
}

/** Whether a run has the time limit that the environment's threshold assumes. */
function hasOwnLimit(entry, settings) {
  return settings.max_episode_steps === entry.max_episode_steps;
}

/** The stroke and the words of the lines to compare with in the key. */
const MARKS = {
  threshold: ["2px dotted", "threshold of a solved task"],
  optimal: ["2px dashed", "greatest expected return"],
  "best known": ["2px dashed", "best known return"],
};

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

  /** `names`: those of the agents if two are compared. */
  showKey(seeds, episodes, marks, word, names) {
    const width = counted(windowOf(episodes), "episode");
    const mean = `mean of ${width}`;
    const lines = names.length
      ? names.map((name, index) => [["warm", "second"][index], "3px solid", seeds > 1 ? `${name}, mean of ${seeds} seeds` : `${name}, ${mean}`])
      : seeds > 1
        ? [["accent", "1px solid", `each seed, ${mean}`], ["warm", "3px solid", `mean of ${seeds} seeds, with its 95 % interval`]]
        : [["accent", "3px dotted", `${word} of each episode`], ["warm", "3px solid", mean]];
    for (const { name, value } of marks) {
      const [stroke, text] = MARKS[name];
      lines.push(["good", stroke, `${text}: ${number(value)}`]);
    }
    const shown = JSON.stringify(lines);
    if (shown === this.shown) return;
    this.shown = shown;
    this.list.replaceChildren(
      ...lines.map(([color, stroke, text]) => {
        const item = make("li", { textContent: text });
        item.style.setProperty("--color", `var(--${color})`);
        item.style.setProperty("--stroke", stroke);
        return item;
      }),
    );
  }
}
