// Parses typed numbers. Values that are not finite or out of range are rejected with a message that names the setting.

const NUMBER = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;

/**
 * The largest value of a setting. A learning rate may be up to 2 with tile coding, which divides it among the tilings.
 */
export function highest(name, definition, settings) {
  if (name === "learning_rate" && settings.discretizer === "tiles") return 2;
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
  return { steps, value, position };
}

function decimals(width) {
  return width > 20 ? 0 : width > 2 ? 1 : 2;
}
