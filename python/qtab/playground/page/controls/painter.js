// Painting a grid world: walls, starts, goals and rewards, the size of the grid, and the rewards of steps and goals.

import { make, radioButtons, refusalPlace, refuse } from "./elements.js";
import { readNumber } from "../format.js";
import { copyGrid, MAX_SIDE, PAINTED, REWARD_LIMITS } from "../store.js";

const TOOLS = [
  ["select", "Select"],
  ["#", "Wall"],
  [".", "Free"],
  ["S", "Start"],
  ["G", "Goal"],
  ["reward", "Reward"],
];

const MOVES = [[-1, 0], [0, 1], [1, 0], [0, -1]];

/** Why an agent cannot reach a goal of a grid world; empty if it can from each start. */
export function unreachable({ layout, wind }) {
  if (!layout.join("").includes("G")) return "There is no goal: every episode lasts until time is up.";
  const [rows, columns] = [layout.length, layout[0].length];
  const within = (index, count) => Math.min(Math.max(index, 0), count - 1);
  const reaches = (start) => {
    const seen = new Set([start]);
    for (const cell of seen) {
      const [row, column] = [Math.floor(cell / columns), cell % columns];
      if (layout[row][column] === "G") return true;
      for (const [down, right] of MOVES) {
        const [to, across] = [within(row + down - wind[column], rows), within(column + right, columns)];
        if (layout[to][across] !== "#") seen.add(to * columns + across);
      }
    }
    return false;
  };
  const starts = [...layout.join("")].flatMap((letter, cell) => (letter === "S" ? [cell] : []));
  const cut = starts.filter((start) => !reaches(start)).length;
  if (!cut) return "";
  const from = starts.length === 1 ? "the start" : cut === starts.length ? "any start" : "some starts";
  const obstacles = wind.some(Boolean) ? "Walls or wind" : "Walls";
  return `${obstacles} cut the goal off from ${from}: such an episode lasts until time is up.`;
}

/** The tools of the painted grid. `paint(cell)` applies the chosen tool to a cell. */
export class Painter {
  constructor(place, store, announce) {
    Object.assign(this, { place, store, announce });
    this.tool = "select";
    this.reward = -10;
    this.stroke = null;
    this.fields = [];
    this.refused = refusalPlace();
    this.warning = make("p", { className: "warning", hidden: true, role: "status" });
    place.append(
      make("h3", { textContent: "Paint the grid world" }),
      make("p", { textContent: "Choose a tool and draw on the first map, with the pointer or with the arrow keys and Enter. Every change trains the agent again." }),
      make("div", { className: "tools-row" }, this.toolButtons(), this.number("reward to paint", "reward", () => this.reward, (value) => { this.reward = value; })),
      make("div", { className: "tools-row" }, ...this.sizes(), ...this.rewards(), this.starts()),
      this.refused,
      this.warning,
    );
    store.subscribe(() => this.refresh());
    this.refresh();
  }

  get isPainting() {
    return this.store.state.environment === PAINTED && this.tool !== "select";
  }

  refresh() {
    const { environment, grid } = this.store.state;
    this.place.hidden = environment !== PAINTED;
    if (!grid) return;
    for (const show of this.fields) show();
    const problem = unreachable(grid);
    this.warning.hidden = !problem;
    if (this.warning.textContent !== problem) this.warning.textContent = problem;
  }

  toolButtons() {
    const group = make("div", { className: "segments", role: "radiogroup", "aria-label": "Tool" });
    const choose = (tool) => {
      this.tool = tool;
      mark(tool);
      document.querySelector("#values").parentElement.classList.toggle("painting", this.isPainting);
    };
    const mark = radioButtons(group, "tool", TOOLS, choose);
    choose(this.tool);
    return make("div", { className: "group" }, make("span", { textContent: "Tool" }), group);
  }

  /** A control below its label. */
  labelled(text, id, control) {
    return make("div", { className: "group" }, make("span", {}, make("label", { htmlFor: id, textContent: text })), control);
  }

  number(label, name, get, set, limits = REWARD_LIMITS) {
    const onchange = () => {
      const { value, refused } = readNumber(label, input.value, limits);
      refuse(this.refused, input, refused);
      if (!refused) set(value);
    };
    const input = make("input", { type: "text", inputMode: "decimal", id: `paint-${name}`, onchange });
    this.fields.push(() => {
      if (!input.hasAttribute("aria-invalid")) input.value = String(get());
    });
    return this.labelled(label[0].toUpperCase() + label.slice(1), input.id, input);
  }

  starts() {
    const { grids } = this.store.definitions.environments[PAINTED];
    const options = Object.keys(grids).map((value) => make("option", { value, textContent: value }));
    const onchange = () => {
      if (select.value) this.change(copyGrid(grids[select.value]));
      select.value = "";
    };
    const select = make("select", { id: "paint-begin", onchange }, make("option", { value: "", textContent: "Choose…" }), ...options);
    const onclick = () => {
      const { grid } = this.store.state;
      this.change({ ...grid, layout: grid.layout.map((line) => line.replaceAll("#", ".")), rewards: [] });
    };
    const clear = make("button", { type: "button", textContent: "Clear walls and rewards", onclick });
    return this.labelled("Begin with", select.id, make("div", { className: "buttons" }, select, clear));
  }

  sizes() {
    const limits = { low: 1, high: MAX_SIDE, integer: true };
    const resized = (rows, columns) => {
      const grid = copyGrid(this.store.state.grid);
      const line = (text = "") => text.slice(0, columns).padEnd(columns, ".");
      grid.layout = Array.from({ length: rows }, (_, row) => line(grid.layout[row]));
      grid.wind = Array.from({ length: columns }, (_, column) => grid.wind[column] ?? 0);
      grid.rewards = grid.rewards.filter(([row, column]) => row < rows && column < columns);
      if (!grid.layout.join("").includes("S")) grid.layout[0] = `S${grid.layout[0].slice(1)}`;
      this.change(grid);
    };
    const layout = () => this.store.state.grid.layout;
    return [
      this.number("rows", "rows", () => layout().length, (rows) => resized(rows, layout()[0].length), limits),
      this.number("columns", "columns", () => layout()[0].length, (columns) => resized(layout().length, columns), limits),
    ];
  }

  rewards() {
    const field = (label, name) =>
      this.number(label, name, () => this.store.state.grid[name], (value) => this.change({ ...this.store.state.grid, [name]: value }));
    return [field("reward of a step", "step_reward"), field("reward at the goal", "goal_reward")];
  }

  change(grid) {
    this.store.update({ grid });
  }

  /** Paints a cell. `how`: "press" begins a stroke of the pointer, "drag" continues it, "key" is a single cell. */
  paint(cell, how) {
    const grid = copyGrid(this.store.state.grid);
    const columns = grid.layout[0].length;
    const [row, column] = [Math.floor(cell / columns), cell % columns];
    const old = grid.layout[row][column];
    const place = (letter) => {
      const line = grid.layout[row];
      grid.layout[row] = line.slice(0, column) + letter + line.slice(column + 1);
    };
    if (how !== "drag") this.stroke = this.tool === "#" && old === "#" ? "." : this.tool;
    const tool = this.stroke ?? this.tool;
    const others = grid.rewards.filter(([down, right]) => down !== row || right !== column);
    if (tool === "reward") {
      if (old === "#") return;
      const had = grid.rewards.some((each) => each[0] === row && each[1] === column && each[2] === this.reward);
      grid.rewards = had && how !== "drag" ? others : [...others, [row, column, this.reward]];
    } else if (old === tool) {
      return;
    } else if (tool === "S") {
      grid.layout = grid.layout.map((line) => line.replaceAll("S", "."));
      place("S");
    } else if (old === "S" && grid.layout.join("").split("S").length === 2) {
      this.announce("The grid needs a start. Place the start elsewhere first.");
      return;
    } else {
      place(tool);
      if (tool === "#") grid.rewards = others;
    }
    this.change(grid);
    const names = { "#": "wall", ".": "free", S: "start", G: "goal", reward: `reward ${this.reward}` };
    if (how === "key") this.announce(`Row ${row + 1}, column ${column + 1}: ${names[tool]}.`);
  }
}
