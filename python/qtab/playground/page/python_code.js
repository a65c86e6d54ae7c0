// The run as a Python program, which gives the same table.

const INDENT = "    ";

/** Python's literal of a value. */
export function literal(value) {
  if (typeof value === "boolean") return value ? "True" : "False";
  if (value === null) return "None";
  if (Array.isArray(value)) return `(${value.map(literal).join(", ")}${value.length === 1 ? "," : ""})`;
  if (typeof value === "object") return `{${Object.entries(value).map(([name, part]) => `${literal(name)}: ${literal(part)}`).join(", ")}}`;
  return typeof value === "string" ? JSON.stringify(value) : String(value);
}

/** The settings that Python would otherwise choose differently: all but the defaults that no preset changes. */
function neededSettings({ state, entry, definitions }) {
  const [preset] = Object.values(entry.presets);
  const byPreset = entry.python ? preset : {};
  return Object.entries(state.settings).filter(([name, value]) => {
    if (name === "discretizer") return entry.states === null;
    if (name === "max_episode_steps" && entry.python) return value !== entry.max_episode_steps;
    if (name in byPreset || name in (entry.options ?? {})) return true;
    return literal(value) !== literal(definitions.settings[name].default);
  });
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

/** The program of a store's state. */
export function pythonProgram(store) {
  const { state, entry } = store;
  const many = state.seeds > 1;
  const settings = [
    many ? `seeds=range(${state.seed}, ${state.seed + state.seeds})` : `seed=${state.seed}`,
    ...(Object.keys(entry.env_kwargs).length ? [`env_kwargs=${literal(entry.env_kwargs)}`] : []),
    ...neededSettings(store).map(([name, value]) => `${name}=${literal(value)}`),
    ...(many ? ["tables=True"] : []),
  ];
  const lines = ["import qtab"];
  if (!entry.python) lines.push("from qtab.envs.grid_worlds import grid_world", "", ...gridLines(gridOf(store), many));
  const env = entry.python ? literal(entry.python) : many ? "make_env" : "env";
  lines.push("", many ? "runs = qtab.train_many(" : "run = qtab.train(", ...[env, ...settings].map((each) => `${INDENT}${each},`), ")");
  if (many) lines.push("print(runs.final_returns())  # the mean return of the last 100 episodes of each seed", "run = runs[0]");
  else lines.push("print(run.episode_returns[-100:].mean())  # the mean return of the last 100 episodes");
  lines.push(state.settings.discretizer === "tiles" ? "print(run.tables)" : "print(run.q_table)");
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
    const area = Object.assign(document.createElement("textarea"), { value: text });
    area.style.position = "fixed";
    area.style.opacity = "0";
    (document.querySelector("dialog[open]") ?? document.body).append(area);
    area.select();
    const copied = document.execCommand("copy");
    area.remove();
    return copied;
  }
}
