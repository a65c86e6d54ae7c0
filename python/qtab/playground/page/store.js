// The reader's choices: environment, settings, seeds, the painted grid. Everything else follows from them.
// The values of a control, a link or an example are limited to those that the engine accepts together.

import { complete } from "./engine.js";
import { highest, isWeighted } from "./format.js";

// The limits of other settings depend on these.
const FIRST = ["episodes", "learning_rate", "epsilon"];

/**
 * All settings that apply in an environment, based on the given ones: choices that others exclude are reset to their
 * defaults, or to the first one that is possible, and numbers are limited to their ranges.
 */
export function fit(definitions, environment, given) {
  const known = definitions.environments[environment];
  const settings = complete(environment, withoutConflicts(definitions, complete(environment, given)));
  for (const name of [...FIRST, ...Object.keys(settings)]) {
    const { type, low } = definitions.settings[name];
    if (!(name in settings) || !["number", "integer"].includes(type)) continue;
    settings[name] = Math.max(Math.min(settings[name], highest(name, definitions.settings[name], settings, definitions)), low);
  }
  if (settings.low?.some((low, index) => low >= settings.high[index])) Object.assign(settings, { low: known.options.low, high: known.options.high });
  return settings;
}

function withoutConflicts({ rules, settings: known }, given) {
  const settings = { ...given };
  const isExcluded = (name, choice) =>
    rules.some(({ setting, value, unless }) => {
      const [[other, chosen]] = Object.entries(unless);
      return setting === name && value === choice && settings[other] === chosen;
    });
  for (const name of new Set(rules.map(({ setting }) => setting))) {
    if (!isExcluded(name, settings[name])) continue;
    const choices = [known[name].default, ...known[name].choices.map(({ value }) => value)];
    settings[name] = choices.find((choice) => !isExcluded(name, choice));
  }
  return settings;
}

export const MANY_SEEDS = 16;
export const SEED_LIMITS = { low: 0, high: 2 ** 32 - 1 - MANY_SEEDS, integer: true };
export const PAINTED = "grid";
/** The largest number of rows and columns of a painted grid, and the limits of its rewards. */
export const MAX_SIDE = 20;
export const REWARD_LIMITS = { low: -1000, high: 1000, integer: false };
/** The number of rows and columns of a map if the table has no cells of two components. */
const RASTER = 48;

/** The choices, their checks, and the listeners for changes. */
export class Store {
  constructor(definitions) {
    this.definitions = definitions;
    this.listeners = new Set();
    this.setAside = null;
    this.state = this.initial(Object.keys(definitions.environments)[0]);
  }

  /** The state of an environment with its first preset, without an agent to compare with. */
  initial(environment, preset = null) {
    const entry = this.definitions.environments[environment];
    const name = preset ?? Object.keys(entry.presets)[0];
    return {
      environment,
      settings: complete(environment, entry.presets[name]),
      seed: 0,
      seeds: 1,
      compared: null,
      grid: copyGrid(Object.values(entry.grids ?? {})[0]),
    };
  }

  get entry() {
    return this.definitions.environments[this.state.environment];
  }

  /** Calls a function with the state after each change, and the names of the changed parts. */
  subscribe(listener) {
    this.listeners.add(listener);
  }

  /** Changes parts of the state. Settings are made compatible: those that no longer apply are dropped. */
  update(changes) {
    const state = { ...this.state, ...changes };
    if (changes.settings) state.settings = fit(this.definitions, state.environment, changes.settings);
    this.state = state;
    for (const listener of this.listeners) listener(state, Object.keys(changes));
  }

  /** Changes one setting, and those that come with it. */
  set(name, value) {
    const implied = name === "discretizer" ? this.impliedBy(value) : {};
    this.update({ settings: { ...this.state.settings, [name]: value, ...implied } });
  }

  /** The settings that come with another discretizer. Those that Fourier features replace are set aside. */
  impliedBy(discretizer) {
    const { environment, settings } = this.state;
    const cells = this.setAside?.environment === environment ? this.setAside.settings : this.initial(environment).settings;
    if (!isWeighted(settings) && isWeighted({ discretizer })) this.setAside = { environment, settings };
    return impliedBy(this.definitions, discretizer, settings, cells);
  }

  /** The reason why a choice is impossible with the others; null if it is possible. */
  impossible(name, value) {
    if (name === "discretizer" && !this.entry.discretizers.includes(value)) {
      return this.entry.states === null
        ? value === "identity"
          ? "the observations are not numbered states"
          : this.entry.observations.some(({ low }) => low === null)
            ? "some observations have no bounds"
            : `too many cells with ${this.entry.observations.length} components`
        : "the states are numbered and need none";
    }
    const { rules, settings: known } = this.definitions;
    const isChosen = (setting, choice) => this.state.settings[setting] === choice;
    const notWith = (setting, choice) => `not with ${known[setting].choices.find((each) => each.value === choice).title}`;
    for (const rule of rules) {
      const [[other, chosen]] = Object.entries(rule.unless);
      if (rule.setting === name && rule.value === value && isChosen(other, chosen)) return notWith(other, chosen);
      const isReverse = other === name && chosen === value && rule.setting === "algorithm";
      if (isReverse && isChosen("algorithm", rule.value)) return notWith("algorithm", rule.value);
    }
    return null;
  }

  /** The settings of the agent to compare with, which differs in its algorithm; null if there is none. */
  get otherSettings() {
    const { environment, settings, compared } = this.state;
    const isKnown = this.definitions.settings.algorithm.choices.some(({ value }) => value === compared);
    if (!isKnown || compared === settings.algorithm || this.impossible("algorithm", compared)) return null;
    return fit(this.definitions, environment, { ...settings, algorithm: compared });
  }

  /** The request for the engine. */
  request(settings = this.state.settings) {
    const { environment, seed, seeds, grid } = this.state;
    const asked = environment === PAINTED ? { id: environment, ...grid } : { id: environment };
    const { map: plane, observations } = this.entry;
    const map = plane ? { map: { x: plane.x.component, y: plane.y.component, at: observations.map(() => 0), columns: RASTER, rows: RASTER } } : {};
    return { environment: asked, settings, seeds: Array.from({ length: seeds }, (_, index) => seed + index), ...map };
  }
}

/**
 * The settings that come with a discretizer that replaces that of other settings: a step size of Fourier features means
 * something else than one of cells. What they replace comes back with cells, from the settings `cells`.
 */
export function impliedBy({ implied }, discretizer, settings, cells) {
  const [before, after] = [implied[settings.discretizer], implied[discretizer]];
  if (before && !after) return Object.fromEntries(Object.entries(cells).filter(([name]) => name in before));
  return before ? {} : { ...after };
}

/** A copy of a grid world that can be changed. */
export function copyGrid(grid) {
  if (!grid) return null;
  return { ...grid, layout: [...grid.layout], wind: [...grid.wind], rewards: grid.rewards.map((each) => [...each]) };
}
