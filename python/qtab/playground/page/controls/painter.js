// Painting a grid world: walls, starts, goals and rewards, the size of the grid, and the rewards of steps and goals.

import { make, refusalPlace, refuse } from "./elements.js";
import { moveWithArrows } from "./environments.js";
import { readNumber } from "../format.js";
import { copyGrid, PAINTED } from "../store.js";

const MAX_SIDE = 20;
const TOOLS = [
  ["select", "Select"],
  ["#", "Wall"],
  [".", "Free"],
  ["S", "Start"],
  ["G", "Goal"],
  ["reward", "Reward"],
];

/** The tools of the painted grid. `paint(cell)` applies the chosen tool to a cell. */
export class Painter {
  constructor(place, store, announce) {
    Object.assign(this, { place, store, announce });
    this.tool = "select";
    this.reward = -10;
    this.stroke = null;
    this.fields = [];
    this.refused = refusalPlace();
    place.append(
      make("h3", { textContent: "Paint the grid world" }),
      make("p", { textContent: "Choose a tool and draw on the first map, with the pointer or with the arrow keys and Enter. Every change trains the agent again." }),
      make("div", { className: "tools-row" }, this.toolButtons(), this.number("reward to paint", "reward", () => this.reward, (value) => { this.reward = value; })),
      make("div", { className: "tools-row" }, ...this.sizes(), ...this.rewards(), this.starts()),
      this.refused,
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
    if (grid) for (const field of this.fields) field.show();
  }

  labelled(text, ...children) {
    return make("div", { className: "group" }, make("span", { textContent: text }), ...children);
  }

  toolButtons() {
    const group = make("div", { className: "segments" });
    group.setAttribute("role", "radiogroup");
    group.setAttribute("aria-label", "Tool");
    const choose = (chosen) => {
      this.tool = chosen;
      for (const button of group.children) {
        button.setAttribute("aria-checked", button.dataset.tool === chosen);
        button.tabIndex = button.dataset.tool === chosen ? 0 : -1;
      }
      document.querySelector("#values").parentElement.classList.toggle("painting", this.isPainting);
    };
    for (const [tool, name] of TOOLS) {
      const button = make("button", { type: "button", textContent: name });
      button.dataset.tool = tool;
      button.setAttribute("role", "radio");
      button.addEventListener("click", () => choose(tool));
      group.append(button);
    }
    moveWithArrows(group, (button) => button.click());
    choose(this.tool);
    return this.labelled("Tool", group);
  }

  number(label, name, get, set, limits = { low: -1000, high: 1000, integer: false }) {
    const input = make("input", { type: "text", inputMode: "decimal", id: `paint-${name}` });
    input.addEventListener("change", () => {
      const { value, refused } = readNumber(label, input.value, limits);
      refuse(this.refused, input, refused);
      if (!refused) set(value);
    });
    const show = () => {
      if (!input.hasAttribute("aria-invalid")) input.value = String(get());
    };
    this.fields.push({ show });
    const text = make("label", { htmlFor: input.id, textContent: label[0].toUpperCase() + label.slice(1) });
    return make("div", { className: "group" }, make("span", {}, text), input);
  }

  starts() {
    const select = make("select", { id: "paint-begin" });
    const { grids } = this.store.definitions.environments[PAINTED];
    select.append(make("option", { value: "", textContent: "Choose…" }), ...Object.keys(grids).map((value) => make("option", { value, textContent: value })));
    select.addEventListener("change", () => {
      if (select.value) this.change(copyGrid(grids[select.value]));
      select.value = "";
    });
    const clear = make("button", { type: "button", textContent: "Clear walls and rewards" });
    clear.addEventListener("click", () => {
      const grid = copyGrid(this.store.state.grid);
      grid.layout = grid.layout.map((line) => line.replaceAll("#", "."));
      this.change({ ...grid, rewards: [] });
    });
    const label = make("label", { htmlFor: select.id, textContent: "Begin with" });
    return make("div", { className: "group" }, make("span", {}, label), make("div", { className: "buttons" }, select, clear));
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
    const { state } = this.store;
    const layout = () => this.store.state.grid?.layout ?? state.grid?.layout ?? ["S"];
    return [
      this.number("rows", "rows", () => layout().length, (rows) => resized(rows, layout()[0].length), limits),
      this.number("columns", "columns", () => layout()[0].length, (columns) => resized(layout().length, columns), limits),
    ];
  }

  rewards() {
    const field = (label, name) =>
      this.number(label, name, () => this.store.state.grid?.[name] ?? 0, (value) => this.change({ ...this.store.state.grid, [name]: value }));
    return [field("reward of a step", "step_reward"), field("reward at the goal", "goal_reward")];
  }

  change(grid) {
    this.store.update({ grid, example: null });
  }

  /** Paints a cell. `how`: "press" begins a stroke of the pointer, "drag" continues it, "key" is a single cell. */
  paint(cell, how) {
    const grid = copyGrid(this.store.state.grid);
    const columns = grid.layout[0].length;
    const [row, column] = [Math.floor(cell / columns), cell % columns];
    const old = grid.layout[row][column];
    const place = (letter, at = [row, column]) => {
      const line = grid.layout[at[0]];
      grid.layout[at[0]] = line.slice(0, at[1]) + letter + line.slice(at[1] + 1);
    };
    if (how !== "drag") this.stroke = this.tool === "#" && old === "#" ? "." : this.tool;
    const tool = this.stroke ?? this.tool;
    const others = grid.rewards.filter(([down, right]) => down !== row || right !== column);
    if (tool === "reward") {
      if (old === "#") return;
      const had = others.length < grid.rewards.length && grid.rewards.some((each) => each[0] === row && each[1] === column && each[2] === this.reward);
      grid.rewards = had && how !== "drag" ? others : [...others, [row, column, this.reward]];
    } else if (tool === "S") {
      if (old === "S") return;
      grid.layout = grid.layout.map((line) => line.replaceAll("S", "."));
      place("S");
    } else {
      if (old === tool || (old === "S" && grid.layout.join("").split("S").length === 2)) return this.refuseStart(old, tool);
      place(tool);
      if (tool !== "G") grid.rewards = tool === "." ? grid.rewards : others;
    }
    this.change(grid);
    const names = { "#": "wall", ".": "free", S: "start", G: "goal", reward: `reward ${this.reward}` };
    if (how === "key") this.announce(`Row ${row + 1}, column ${column + 1}: ${names[tool]}.`);
  }

  refuseStart(old, tool) {
    if (old === "S" && old !== tool) this.announce("The grid needs a start. Place the start elsewhere first.");
  }
}
