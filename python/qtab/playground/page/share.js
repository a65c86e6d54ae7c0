// The state in the fragment of the address. The parts of an address are used only as values of controls, all checked.

import { EXAMPLES, exampleOf, exampleState } from "./controls/examples.js";
import { METHODS } from "./counterexample/updates.js";
import { HIGHEST_RATE, readNumber } from "./format.js";
import { impliedBy, MANY_SEEDS, MAX_SIDE, PAINTED, REWARD_LIMITS, SEED_LIMITS } from "./store.js";

const MAX_LENGTH = 8000;
/** The parts of an address besides settings. */
const GRID_NAMES = ["layout", "wind", "step_reward", "goal_reward", "rewards"];
const NAMES = new Set(["env", "example", "seed", "seeds", "compare", "counterexample", ...GRID_NAMES]);

/** The fragment of a state, without "#". */
export function fragment(store) {
  const { state, definitions } = store;
  const example = exampleOf(store);
  const base = new URLSearchParams();
  base.set("env", state.environment);
  if (example !== null) base.set("example", String(example));
  else for (const [name, value] of Object.entries(state.settings)) if (definitions.settings[name]) base.set(name, String(value));
  if (state.seed) base.set("seed", String(state.seed));
  if (state.seeds > 1) base.set("seeds", String(state.seeds));
  if (store.otherSettings) base.set("compare", state.compared);
  if (state.counterexample) base.set("counterexample", state.counterexample);
  if (state.environment === PAINTED && example === null) {
    const { layout, wind, step_reward, goal_reward, rewards } = state.grid;
    base.set("layout", layout.join("/").replaceAll("#", "W"));
    if (wind.some(Boolean)) base.set("wind", wind.join(","));
    base.set("step_reward", String(step_reward));
    base.set("goal_reward", String(goal_reward));
    if (rewards.length) base.set("rewards", rewards.map((each) => each.join(",")).join("/"));
  }
  return base.toString();
}

/** The part of a link that holds the settings: its search and its fragment. A text that is no link is that part. */
export function settingsText(link) {
  return link.trim().replace(/^[^?#]*(?:\?([^#]*)(?:#|$)|#)/, (_, search = "") => (search ? `${search}&` : ""));
}

/** Whether a text names any part of a state. */
export function hasSettings({ definitions }, text) {
  const isKnown = (name) => NAMES.has(name) || Object.hasOwn(definitions.settings, name);
  return text.length <= MAX_LENGTH && [...new URLSearchParams(text).keys()].some(isKnown);
}

/** Sets a store to the state of an address; returns the names of invalid parts, which are omitted or limited. */
export function restore(store, text) {
  const given = new URLSearchParams(text.length > MAX_LENGTH ? "" : text);
  const left = text.length > MAX_LENGTH ? ["the whole address, which is too long"] : [];
  const { environments, settings: known } = store.definitions;
  left.push(...[...given.keys()].filter((name) => !NAMES.has(name) && !Object.hasOwn(known, name)).map((name) => name.slice(0, 40)));
  // Not the page's last environment: a link shows the same in each tab.
  let [environment] = Object.keys(environments);
  const asked = given.get("env");
  if (asked !== null && Object.hasOwn(environments, asked)) environment = asked;
  else if (asked !== null) left.push("env");
  let state = store.initial(environment);
  const { value: example } = whole(given.get("example") ?? "", 0, (EXAMPLES[environment]?.length ?? 0) - 1);
  if (example !== undefined) state = exampleState(store, environment, example);
  else if (given.has("example")) left.push("example");
  else if (![...given.keys()].some((name) => Object.hasOwn(known, name))) state = exampleState(store, environment, 0);
  Object.assign(state, readSeeds(given, left));
  const asks = readSettings(store, given, state, left);
  state.compared = given.get("compare");
  state.counterexample = given.get("counterexample");
  if (state.counterexample !== null && !Object.hasOwn(METHODS, state.counterexample)) {
    left.push("counterexample");
    state.counterexample = null;
  }
  if (environment === PAINTED && given.has("layout")) readGrid(given, state, left);
  else left.push(...GRID_NAMES.filter((name) => given.has(name)));
  store.update(state);
  if (store.state.compared !== null && !store.otherSettings) {
    left.push("compare");
    store.update({ compared: null });
  }
  for (const [name, value] of asks) if (String(store.state.settings[name]) !== String(value)) left.push(name);
  return [...new Set(left)];
}

function whole(text, low, high) {
  return readNumber("", text, { low, high, integer: true });
}

/** The seeds of an address; only the first one if it names none. */
function readSeeds(given, left) {
  const { value: seed } = readNumber("seed", given.get("seed") ?? "0", SEED_LIMITS);
  const seeds = [1, MANY_SEEDS].find((count) => (given.get("seeds") ?? "1") === String(count));
  if (seed === undefined) left.push("seed");
  if (seeds === undefined) left.push("seeds");
  return { seed: seed ?? 0, seeds: seeds ?? 1 };
}

/** Puts the settings of an address into a state; returns their names and values. */
function readSettings(store, given, state, left) {
  const { settings: known, environments } = store.definitions;
  const { discretizers, observations } = environments[state.environment];
  const asks = new Map();
  for (const [name, text] of given) {
    if (!Object.hasOwn(known, name)) continue;
    const value = readSetting(name, text, known[name], observations?.length ?? 1);
    const impossible = value === undefined || (name === "discretizer" && !discretizers.includes(value));
    if (impossible) left.push(name);
    else asks.set(name, value);
  }
  const { environment, settings } = state;
  const discretizer = asks.get("discretizer") ?? settings.discretizer;
  const implied = impliedBy(store.definitions, discretizer, settings, store.initial(environment).settings);
  state.settings = { ...settings, ...implied, ...Object.fromEntries(asks) };
  return asks;
}

/** The value of a setting; undefined if it is invalid. */
function readSetting(name, text, definition, components) {
  const integer = ["integer", "integers"].includes(definition.type);
  const high = name === "learning_rate" ? HIGHEST_RATE : definition.high;
  if (definition.type === "flag") return { true: true, false: false }[text];
  const read = (part) => readNumber(name, part, { low: definition.low, high, integer }).value;
  if (definition.type === "choice") return definition.choices.find(({ value }) => value === text)?.value;
  if (["number", "integer"].includes(definition.type)) return read(text);
  const parts = text.split(",").map(read);
  if (parts.includes(undefined)) return undefined;
  if (definition.type === "initial_q") {
    if (parts.length === 1) return parts[0];
    return parts.length === 2 && parts[0] <= parts[1] ? parts : undefined;
  }
  if (parts.length === components) return parts;
  if (parts.length > 1) return undefined;
  // One value for all: the package accepts a single integer for bins and tiles, but a list for limits and scales.
  return integer ? parts[0] : Array(components).fill(parts[0]);
}

function readGrid(given, state, left) {
  const layout = given.get("layout").replaceAll("W", "#").split("/");
  const columns = layout[0].length;
  const fits =
    layout.length <= MAX_SIDE && columns >= 1 && columns <= MAX_SIDE && layout.join("").includes("S") &&
    layout.every((line) => line.length === columns && /^[.#SG]+$/.test(line));
  if (!fits) {
    left.push("layout");
    return;
  }
  const grid = { layout, wind: Array(columns).fill(0), step_reward: -1, goal_reward: 0, rewards: [] };
  for (const name of ["step_reward", "goal_reward"]) {
    const { value } = readNumber(name, given.get(name) ?? "", REWARD_LIMITS);
    if (value !== undefined) grid[name] = value;
    else if (given.has(name)) left.push(name);
  }
  if (given.has("wind")) {
    const wind = given.get("wind").split(",").map((part) => whole(part, 0, MAX_SIDE).value);
    if (wind.length === columns && !wind.includes(undefined)) grid.wind = wind;
    else left.push("wind");
  }
  if (given.has("rewards")) readRewards(given.get("rewards"), grid, columns, left);
  state.grid = grid;
}

function readRewards(text, grid, columns, left) {
  for (const part of text.split("/")) {
    const [row, column, reward, ...others] = part.split(",");
    const { value: down } = whole(row ?? "", 0, grid.layout.length - 1);
    const { value: right } = whole(column ?? "", 0, columns - 1);
    const { value } = readNumber("rewards", reward ?? "", REWARD_LIMITS);
    if (others.length || [down, right, value].includes(undefined)) {
      left.push("rewards");
      return;
    }
    grid.rewards.push([down, right, value]);
  }
}
