// Makes settings compatible: the values of a control, a link or an example are limited to those the engine accepts.

import { complete } from "./engine.js";
import { highest } from "./numbers.js";

// The limits of other settings depend on these.
const FIRST = ["episodes", "learning_rate", "epsilon"];

/**
 * All settings that apply in an environment, based on the given ones: choices that others exclude are reset to their
 * defaults, and numbers are limited to their ranges.
 */
export function fit(definitions, environment, given) {
  const known = definitions.environments[environment];
  const settings = complete(environment, withoutConflicts(definitions, complete(environment, given)));
  for (const name of [...FIRST, ...Object.keys(settings)]) {
    const { type, low } = definitions.settings[name];
    if (!(name in settings) || !["number", "integer"].includes(type)) continue;
    settings[name] = Math.max(Math.min(settings[name], highest(name, definitions.settings[name], settings)), low);
  }
  if (settings.low?.some((low, index) => low >= settings.high[index])) Object.assign(settings, { low: known.options.low, high: known.options.high });
  return settings;
}

function withoutConflicts({ rules, settings: known }, given) {
  const settings = { ...given };
  for (const { setting, value, unless } of rules) {
    const [[other, chosen]] = Object.entries(unless);
    if (settings[setting] === value && settings[other] === chosen) settings[setting] = known[setting].default;
  }
  return settings;
}
