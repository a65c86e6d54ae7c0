// Canvases that are sharp on every screen, and the axes of a chart.

import { line } from "./shapes.js";
import { themeColors } from "./theme.js";
import { number } from "../format.js";

export const FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Helvetica Neue', sans-serif";

/**
 * The sizes of canvases on the page, in CSS pixels. Reading a size makes the browser compute the layout in each frame.
 */
let sizes = new WeakMap();

/** Measures all canvases again at their next drawing, as the page around them has changed. */
export function forgetSizes() {
  sizes = new WeakMap();
}

function sizeOf(canvas) {
  if (sizes.has(canvas)) return sizes.get(canvas);
  const size = { width: canvas.clientWidth, height: canvas.clientHeight };
  sizes.set(canvas, size);
  return size;
}

/**
 * Clears a canvas and returns its context, scaled so that a unit is a CSS pixel, and its size in such pixels. It has
 * the size of `shown`, a canvas on the page that `onResize` watches.
 */
export function surface(canvas, shown = canvas) {
  const ratio = Math.min(globalThis.devicePixelRatio || 1, 3);
  const size = sizeOf(shown);
  const [width, height] = [Math.max(size.width, 1), Math.max(size.height, 1)];
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const g = canvas.getContext("2d");
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.clearRect(0, 0, width, height);
  g.lineJoin = "round";
  g.lineCap = "round";
  g.textBaseline = "middle";
  g.font = `12px ${FONT}`;
  return { g, width, height };
}

/** Draws again whenever the size of a canvas has changed. */
export function onResize(canvases, draw) {
  const observer = new ResizeObserver((changes) => {
    for (const { target } of changes) sizes.delete(target);
    requestAnimationFrame(draw);
  });
  for (const canvas of canvases) observer.observe(canvas);
}

/** Round numbers that divide a range into about `parts` parts. */
export function ticks(low, high, parts) {
  const span = high - low;
  if (!(span > 0)) return [low];
  const power = 10 ** Math.floor(Math.log10(span / parts));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((size) => span / size <= parts);
  const first = Math.ceil(low / step - 1e-9);
  const last = Math.floor(high / step + 1e-9);
  return Array.from({ length: last - first + 1 }, (_, index) => Number(((first + index) * step).toPrecision(12)));
}

/** A linear map from numbers to pixels. */
export function scale(low, high, from, to) {
  const width = high - low || 1;
  return (value) => from + ((value - low) / width) * (to - from);
}

/** Draws the grid lines and labels of a chart. */
export function axes(g, box, x, y, xTicks, yTicks, names) {
  const colors = themeColors();
  g.fillStyle = colors.muted;
  g.textAlign = "right";
  for (const tick of yTicks) {
    const at = Math.round(y(tick)) + 0.5;
    line(g, [[box.left, at], [box.right, at]], colors.line, 1);
    g.fillText(number(tick), box.left - 8, at);
  }
  for (const tick of xTicks) {
    g.textAlign = x(tick) > box.right - 12 ? "right" : x(tick) < box.left + 12 ? "left" : "center";
    g.fillText(number(tick, 6), x(tick), box.bottom + 14);
  }
  g.textAlign = "right";
  g.fillText(names.x, box.right, box.bottom + 31);
  g.textAlign = "left";
  g.fillText(names.y, 4, 9);
}
