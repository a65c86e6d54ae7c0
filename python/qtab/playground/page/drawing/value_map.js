// A map of the states: values, visits or the optimum, with the policy and the greedy agent's path, and a cell to select.

import { drawCells, drawLetters, drawOutline, drawPath, drawPlaneAxes, drawPolicy, drawRewards, drawTaxiWalls, frameOf } from "./map_drawing.js";
import { dot } from "./shapes.js";
import { onResize, surface } from "./surface.js";
import { onThemeChange, themeColors } from "./theme.js";
import { make } from "../controls/elements.js";

const KEYS = { ArrowLeft: [0, -1], ArrowRight: [0, 1], ArrowUp: [-1, 0], ArrowDown: [1, 0] };

/**
 * A map on a canvas. With `onPick(cell, how)` a cell can be chosen with the pointer or the keyboard: one focusable grid
 * cell lies over the canvas and moves with the arrow keys. `how` is "press", "drag" or "key".
 */
export class StateMap {
  constructor(canvas, { name, describe, onPick }) {
    this.canvas = canvas;
    this.states = document.createElement("canvas");
    this.name = name;
    this.describe = describe;
    this.onPick = onPick;
    this.content = null;
    this.selected = null;
    this.focused = 0;
    this.agent = null;
    onResize([canvas], () => this.draw());
    onThemeChange(() => this.draw());
    if (onPick) this.setUpPicking();
  }

  /**
   * Shows a map: {map, plane, layout, actions, greedy, palette, share, isUnvisited, path, label}. `share(cell)` is the color
   * from 0 to 1; `plane` {x, y} or null; `path` a list of [x, y] in the plane's units, or of cells.
   */
  show(content) {
    this.content = content;
    if (Array.isArray(this.agent) !== Boolean(content.plane)) this.agent = null;
    const cells = content.map.columns * content.map.rows;
    this.focused = Math.min(this.focused, cells - 1);
    if (this.selected >= cells) this.selected = null;
    if (this.agent >= cells) this.agent = null;
    this.canvas.setAttribute("aria-label", content.label);
    if (this.grid) {
      this.grid.setAttribute("aria-rowcount", content.map.rows);
      this.grid.setAttribute("aria-colcount", content.map.columns);
    }
    this.draw();
  }

  /** Shows the agent at a position: [x, y] in the plane's units, or a cell; null hides it. */
  showAgent(place) {
    this.agent = place;
    if (this.frame) this.drawMarks();
  }

  select(cell) {
    this.selected = cell;
    if (cell !== null) this.focused = cell;
    if (this.frame) this.drawMarks();
    this.placeCell();
  }

  draw() {
    if (!this.content) return;
    this.drawStates();
    this.drawMarks();
    this.placeCell();
  }

  /** Draws everything but the agent and the selection, which move often, on a separate canvas. */
  drawStates() {
    const { g, width, height } = surface(this.states, this.canvas);
    const { map, plane, layout, rewards, greedy, palette, path, drawing } = this.content;
    const frame = frameOf(map, plane, width, height);
    this.frame = frame;
    drawCells(g, frame, map.columns * map.rows, palette, this.content);
    if (greedy) drawPolicy(g, frame, map, palette, this.content);
    if (plane) drawPlaneAxes(g, frame, map);
    if (layout) drawLetters(g, frame, layout);
    if (drawing === "taxi") drawTaxiWalls(g, frame, map.columns);
    if (rewards) drawRewards(g, frame, map.columns, rewards);
    if (path) drawPath(g, frame, path.map((place) => place === null ? null : this.point(frame, place)));
  }

  drawMarks() {
    const { g } = surface(this.canvas);
    const { a: ratio } = g.getTransform();
    g.drawImage(this.states, 0, 0, this.states.width / ratio, this.states.height / ratio);
    if (this.agent !== null) dot(g, this.point(this.frame, this.agent), 6, themeColors().warm);
    if (this.selected !== null) drawOutline(g, this.frame.cell(this.selected));
  }

  point(frame, place) {
    if (Array.isArray(place)) return [frame.x(place[0]), frame.y(place[1])];
    const { x, y, width, height } = frame.cell(place);
    return [x + width / 2, y + height / 2];
  }

  setUpPicking() {
    this.cell = this.newCell();
    const named = { "aria-label": `${this.name}: arrow keys move, Enter selects` };
    const onkeydown = (event) => this.pressed(event);
    this.grid = make("div", { className: "map-grid", role: "grid", ...named, onkeydown }, make("div", { role: "row" }, this.cell));
    this.canvas.after(this.grid);
    let last = null;
    const at = (event) => {
      const box = this.canvas.getBoundingClientRect();
      return this.frame?.at(event.clientX - box.left, event.clientY - box.top) ?? null;
    };
    this.canvas.addEventListener("pointerdown", (event) => {
      last = at(event);
      if (last === null || event.button !== 0) return;
      this.focused = last;
      this.placeCell();
      this.onPick(last, "press");
    });
    this.canvas.addEventListener("pointermove", (event) => {
      const cell = event.buttons & 1 ? at(event) : null;
      if (cell === null || cell === last) return;
      last = cell;
      this.onPick(cell, "drag");
    });
  }

  newCell() {
    const onfocus = () => cell.setAttribute("aria-label", this.describe(this.focused));
    const cell = make("div", { className: "map-cell", role: "gridcell", tabIndex: 0, onfocus });
    return cell;
  }

  /** Moves the focus to another cell: a new element, so that screen readers read it. */
  move(cell) {
    this.focused = cell;
    const old = this.cell;
    this.cell = this.newCell();
    old.after(this.cell);
    this.placeCell();
    this.cell.focus();
    old.remove();
  }

  pressed(event) {
    if (!this.content || event.ctrlKey || event.metaKey || event.altKey) return;
    const { columns, rows } = this.content.map;
    const [row, column] = [Math.floor(this.focused / columns), this.focused % columns];
    if (event.key in KEYS) {
      const [down, right] = KEYS[event.key];
      const to = [Math.min(Math.max(row + down, 0), rows - 1), Math.min(Math.max(column + right, 0), columns - 1)];
      this.move(to[0] * columns + to[1]);
    } else if (event.key === "Home") this.move(row * columns);
    else if (event.key === "End") this.move(row * columns + columns - 1);
    else if (event.key === "Enter" || event.key === " ") this.onPick(this.focused, "key");
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  placeCell() {
    if (!this.grid || !this.frame) return;
    const { columns } = this.content.map;
    const { x, y, width, height } = this.frame.cell(this.focused);
    this.cell.setAttribute("aria-rowindex", Math.floor(this.focused / columns) + 1);
    this.cell.setAttribute("aria-colindex", (this.focused % columns) + 1);
    this.cell.setAttribute("aria-selected", this.focused === this.selected);
    Object.assign(this.cell.style, {
      left: `${this.canvas.offsetLeft + x}px`,
      top: `${this.canvas.offsetTop + y}px`,
      width: `${width}px`,
      height: `${height}px`,
    });
  }
}
