// Numbers as text.

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
