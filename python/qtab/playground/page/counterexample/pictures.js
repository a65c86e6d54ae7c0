// Baird's counterexample as a picture: its seven states with their values, and the weights over the sweeps.

import { valueError, valuesOf } from "./updates.js";
import { disc, line, polygon } from "../drawing/shapes.js";
import { axes, FONT, scale, surface, ticks } from "../drawing/surface.js";
import { themeColors } from "../drawing/theme.js";
import { number } from "../format.js";

/** The lines of the chart: a name, the color of the theme, and the number of a weight vector. */
export const LINES = [
  ["w₁ to w₆", "accent", (w) => w[0]],
  ["w₇", "second", (w) => w[6]],
  ["w₈", "warm", (w) => w[7]],
  ["√VE", "good", valueError],
];

/** The largest font, up to a size, in which a text is at most so wide. */
function fitted(g, text, size, width) {
  g.font = `600 ${size}px ${FONT}`;
  return `600 ${Math.min(size, (size * width) / g.measureText(text).width)}px ${FONT}`;
}

/** Draws the states with the solid action, the names of their values beside them and the values inside. */
export function drawStates(canvas, w) {
  const { g, width, height } = surface(canvas);
  const colors = themeColors();
  const radius = Math.min(width / 16, 30);
  const places = Array.from({ length: 6 }, (_, state) => [10 + ((state + 0.5) * (width - 20)) / 6, radius + 28]);
  const lower = [width / 2, height - radius - 22];
  // The head of an arrow with a tip and a direction.
  const head = ([x, y], [right, down]) => {
    const [backX, backY] = [x - 9 * right, y - 9 * down];
    polygon(g, [[x, y], [backX - 4 * down, backY + 4 * right], [backX + 4 * down, backY - 4 * right]], colors.muted);
  };
  for (const [x, y] of places) {
    const length = Math.hypot(lower[0] - x, lower[1] - y);
    const [right, down] = [(lower[0] - x) / length, (lower[1] - y) / length];
    const at = (distance) => [x + right * distance, y + down * distance];
    line(g, [at(radius), at(length - radius - 8)], colors.muted, 1.2);
    head(at(length - radius - 1), [right, down]);
  }
  // From the lower state the solid action returns to it: three quarters of a circle, which its disc then partly covers.
  g.beginPath();
  g.arc(lower[0] + radius * 1.25, lower[1], radius * 0.6, -0.75 * Math.PI, 0.65 * Math.PI);
  g.stroke();
  head([lower[0] + radius * 0.9, lower[1] + radius * 0.48], [-0.8, -0.6]);
  g.setLineDash([4, 4]);
  const ring = [places[0][0] - radius - 8, places[0][1] - radius - 8, places[5][0] - places[0][0] + 2 * radius + 16, 2 * radius + 16];
  g.beginPath();
  g.roundRect(...ring, radius + 8);
  g.stroke();
  g.setLineDash([]);
  const values = valuesOf(w);
  g.textAlign = "center";
  [...places, lower].forEach(([x, y], state) => {
    disc(g, x, y, radius, colors.card);
    g.strokeStyle = colors.ink;
    g.lineWidth = 1.6;
    g.stroke();
    g.fillStyle = colors.ink;
    const text = number(values[state], 3);
    g.font = fitted(g, text, Math.max(radius * 0.46, 9), radius * 1.75);
    g.fillText(text, x, y);
    g.font = `12px ${FONT}`;
    g.fillStyle = colors.muted;
    if (state === 6) g.fillText("w₇ + 2w₈", x, y + radius + 12);
  });
  g.fillText("2w₁ + w₈, …, 2w₆ + w₈", width / 2, 8);
}

/** Draws the weights after each of the first sweeps, with dots at the last ones. */
export function drawWeights(canvas, weights, sweeps) {
  const { g, width, height } = surface(canvas);
  const colors = themeColors();
  const shown = weights.slice(0, sweeps + 1);
  const lines = LINES.map(([, color, of]) => [colors[color], shown.map(of)]);
  const all = lines.flatMap(([, numbers]) => numbers);
  const [lowest, highest] = [Math.min(0, ...all), Math.max(...all)];
  const margin = (highest - lowest || 1) * 0.05;
  const box = { left: 58, right: width - 14, top: 22, bottom: height - 42 };
  const x = scale(0, Math.max(sweeps, 1), box.left, box.right);
  const y = scale(lowest - margin, highest + margin, box.bottom, box.top);
  const places = ticks(0, Math.max(sweeps, 1), width < 420 ? 4 : 5).filter(Number.isInteger);
  axes(g, box, x, y, places, ticks(lowest - margin, highest + margin, 6), { x: "sweep", y: "weight or error" });
  for (const [color, numbers] of lines) {
    const points = numbers.map((each, sweep) => [x(sweep), y(each)]);
    line(g, points, color, 2.2);
    disc(g, ...points.at(-1), 3.2, color);
  }
}
