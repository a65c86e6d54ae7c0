// The run as a Python program, which learns the same table unless the task is chaotic.

import { make } from "./controls/elements.js";
import { counted, hasCells } from "./format.js";
import { lastOf } from "./results/statistics.js";

const INDENT = "    ";

/** A value as a Python literal. */
export function literal(value) {
  if (typeof value === "boolean") return value ? "True" : "False";
  if (value === null) return "None";
  if (Array.isArray(value)) return `(${value.map(literal).join(", ")}${value.length === 1 ? "," : ""})`;
  if (typeof value === "object") return `{${Object.entries(value).map(([name, part]) => `${literal(name)}: ${literal(part)}`).join(", ")}}`;
  return typeof value === "string" ? JSON.stringify(value) : String(value);
}

function gridLines(grid, asFunction) {
  const rows = grid.layout.map((line) => `${INDENT}${literal(line)},`);
  const options = [
    grid.wind.some(Boolean) ? `wind=${literal(grid.wind)}` : null,
    `step_reward=${literal(grid.step_reward)}`,
    `goal_reward=${literal(grid.goal_reward)}`,
    grid.rewards.length ? `rewards={${grid.rewards.map(([row, column, reward]) => `(${row}, ${column}): ${reward}`).join(", ")}}` : null,
  ];
  const call = `grid_world(layout, ${options.filter(Boolean).join(", ")})`;
  const made = asFunction ? ["", "", "def make_env():", `${INDENT}return ${call}`, ""] : [`env = ${call}`];
  return ["layout = (", ...rows, ")", ...made];
}

/** The number below the learning curve: the mean of the last episodes. */
function printedMean({ settings, seeds }, measure) {
  const width = lastOf(settings.episodes);
  const [array, words] = measure === "lengths" ? ["episode_lengths", "number of steps"] : ["episode_returns", "return"];
  const [mean, of] = seeds > 1 ? [`runs.${array}[:, -${width}:]`, ` of ${seeds} seeds`] : [`run.${array}[-${width}:]`, ""];
  return `print(${mean}.mean())  # the mean ${words} of the last ${counted(width, "episode")}${of}`;
}

/**
 * The program of a store's state. It names every setting, so that it does not depend on Python's defaults or presets.
 * `measure` is that of the learning curve, "returns" or "lengths".
 */
export function pythonProgram(store, measure = "returns") {
  const { state, entry } = store;
  const many = state.seeds > 1;
  const settings = [
    many ? `seeds=range(${state.seed}, ${state.seed + state.seeds})` : `seed=${state.seed}`,
    ...(Object.keys(entry.env_kwargs).length ? [`env_kwargs=${literal(entry.env_kwargs)}`] : []),
    ...Object.entries(state.settings).map(([name, value]) => `${name}=${literal(value)}`),
    ...(many ? ["tables=True"] : []),
  ];
  const lines = ["import qtab"];
  if (!entry.python) lines.push("from qtab.envs.grid_worlds import grid_world", "", ...gridLines(gridOf(store), many));
  const env = entry.python ? literal(entry.python) : many ? "make_env" : "env";
  lines.push("", many ? "runs = qtab.train_many(" : "run = qtab.train(", ...[env, ...settings].map((each) => `${INDENT}${each},`), ")");
  lines.push(printedMean(state, measure), ...(many ? ["run = runs[0]"] : []));
  lines.push(hasCells(state.settings) ? "print(run.q_table)" : "print(run.tables)");
  return `${lines.join("\n")}\n`;
}

/** The grid world of a state: the painted one, or that of the environment. */
function gridOf({ state, entry }) {
  return state.grid ?? Object.values(entry.grids)[0];
}

/** Copies a text; returns whether the browser allowed it. */
export async function copyText(text) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    const area = make("textarea", { value: text });
    area.style.position = "fixed";
    area.style.opacity = "0";
    (document.querySelector("dialog[open]") ?? document.body).append(area);
    area.select();
    const copied = document.execCommand("copy");
    area.remove();
    return copied;
  }
}
