// Numbers as text, and typed numbers: those that are not finite or out of range are rejected with a message.

import { definitions } from "./engine.js";

const WHOLE = new Intl.NumberFormat("en-US", { maximumFractionDigits: 0 });

/** A number with up to `digits` significant digits, a true minus sign, and words for non-finite numbers. */
export function number(value, digits = 4) {
  if (Number.isNaN(value)) return "not a number";
  if (!Number.isFinite(value)) return value > 0 ? "infinity" : "−infinity";
  if (value === 0) return "0";
  const magnitude = Math.abs(value);
  const text =
    magnitude >= 1e6 || magnitude < 1e-4
      ? value.toExponential(Math.max(digits - 2, 1)).replace(/\.?0+e/, "e").replace("e+", "e")
      : magnitude >= 10 ** digits
        ? WHOLE.format(value)
        : String(Number(value.toPrecision(digits)));
  return text.replace(/-/g, "−");
}

/** Numbers to compare, with enough digits to distinguish different ones. */
export function distinguished(values) {
  const different = new Set(values).size;
  for (let digits = 4; ; digits++) {
    const texts = Array.from(values, (value) => number(value, digits));
    if (new Set(texts).size === different || digits === 17) return texts;
  }
}

/** A whole number with separators. */
export function count(value) {
  return WHOLE.format(value).replace("-", "−");
}

/** A count with its noun: 1 step, 2 steps. */
export function counted(value, noun) {
  return `${count(value)} ${noun}${value === 1 ? "" : "s"}`;
}

/** A factor inside an equation; negative ones are in parentheses. */
export function term(value, digits = 4) {
  return value < 0 ? `(${number(value, digits)})` : number(value, digits);
}

const NUMBER = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;

/** The largest learning rate if states have no cells of their own: with tile coding it is divided among the tilings. */
export const HIGHEST_RATE = 2;

/** Whether the features of states are numbers, which multiply all weights. */
export function isWeighted({ discretizer }) {
  return discretizer in definitions.implied;
}

/** Whether each state is one row of the table. */
export function hasCells(settings) {
  return settings.discretizer !== "tiles" && !isWeighted(settings);
}

/** The largest value of a setting beside others. */
export function highest(name, definition, settings, { max_features }) {
  if (name === "learning_rate" && !hasCells(settings)) return HIGHEST_RATE;
  if (name === "order" && settings.coupled) return Math.floor(max_features ** (1 / settings.low.length) + 1e-9) - 1;
  if (name === "min_epsilon") return settings.epsilon;
  if (name === "min_learning_rate") return settings.learning_rate;
  if (name.endsWith("_warm_up")) return settings.episodes - 1;
  return definition.high;
}

/** Returns {value} or {refused}: a message. */
export function readNumber(name, text, { low, high, integer }) {
  const typed = text.trim().replace("−", "-");
  const shown = typed.length > 24 ? `${typed.slice(0, 24)}…` : typed;
  const kind = integer ? "an integer" : "a number";
  if (!NUMBER.test(typed)) return { refused: `${name} must be ${kind}, got ${typed ? `"${shown}"` : "nothing"}` };
  const value = Number(typed);
  if (!Number.isFinite(value)) return { refused: `${name} must be finite, got ${shown}` };
  if (integer && !Number.isInteger(value)) return { refused: `${name} must be an integer, got ${shown}` };
  if ((low !== null && value < low) || (high !== null && value > high)) {
    const range = low === null ? `at most ${high}` : high === null ? `at least ${low}` : `in [${low}, ${high}]`;
    return { refused: `${name} must be ${range}, got ${shown}` };
  }
  return { value };
}

/** The range of a slider. Learning rates of weighted features are small, and only their order of magnitude matters. */
export function sliderRange(name, limits, settings) {
  return name === "learning_rate" && isWeighted(settings) ? { low: 1e-4, high: 1, integer: false, log: true } : limits;
}

/** Converts between the positions 0 to 1000 of a slider and values, on a linear or logarithmic scale. */
export function positions({ low, high, integer, log }) {
  const steps = 1000;
  const start = Math.log(Math.max(low, 1e-12));
  const end = Math.log(Math.max(high, 1e-12));
  const value = (position) => {
    const share = position / steps;
    const exact = log ? Math.exp(start + share * (end - start)) : low + share * (high - low);
    if (position <= 0) return low;
    if (position >= steps) return high;
    if (integer) return Math.round(log && exact > 100 ? Number(exact.toPrecision(2)) : exact);
    return Number(log ? exact.toPrecision(2) : exact.toFixed(decimals(high - low)));
  };
  const position = (number) =>
    Math.round(steps * (log ? (Math.log(Math.max(number, 1e-12)) - start) / (end - start || 1) : (number - low) / (high - low || 1)));
  return { value, position };
}

function decimals(width) {
  return width > 20 ? 0 : width > 2 ? 1 : Math.min(Math.max(2 - Math.ceil(Math.log10(width)), 2), 12);
}
