// A map on its canvas: the positions of its cells, its axes, and the content of the cells.

import { TAXI_WALLS } from "./games.js";
import { arrow, disc, dot, line, roundBox } from "./shapes.js";
import { FONT, scale, ticks } from "./surface.js";
import { css, inkOn, shade, themeColors } from "./theme.js";
import { number } from "../format.js";

/** Returns the positions of a map's cells within a canvas; `plane` names its two components, null for grids. */
export function frameOf(map, plane, width, height) {
  if (plane) {
    const box = { left: 46, right: width - 8, top: 28, bottom: height - 38 };
    return planeFrame(map, plane, box);
  }
  const size = Math.floor(Math.min((width - 4) / map.columns, (height - 4) / map.rows) * 4) / 4;
  const left = (width - size * map.columns) / 2;
  const top = (height - size * map.rows) / 2;
  const box = { left, top, right: left + size * map.columns, bottom: top + size * map.rows };
  const cell = (index) => ({
    x: left + (index % map.columns) * size,
    y: top + Math.floor(index / map.columns) * size,
    width: size,
    height: size,
  });
  const at = (x, y) => {
    const [column, row] = [Math.floor((x - left) / size), Math.floor((y - top) / size)];
    const inside = column >= 0 && column < map.columns && row >= 0 && row < map.rows;
    return inside ? row * map.columns + column : null;
  };
  return { box, cell, at, plane: null };
}

function planeFrame(map, plane, box) {
  const { xEdges, yEdges } = map;
  const x = scale(xEdges[0], xEdges[map.columns], box.left, box.right);
  const y = scale(yEdges[map.rows], yEdges[0], box.bottom, box.top);
  const cell = (index) => {
    const column = index % map.columns;
    const row = Math.floor(index / map.columns);
    const [left, top] = [x(xEdges[column]), y(yEdges[row])];
    return { x: left, y: top, width: x(xEdges[column + 1]) - left, height: y(yEdges[row + 1]) - top };
  };
  const at = (left, top) => {
    if (left < box.left || left >= box.right || top < box.top || top >= box.bottom) return null;
    let column = 0;
    while (column < map.columns - 1 && left >= x(xEdges[column + 1])) column++;
    let row = 0;
    while (row < map.rows - 1 && top >= y(yEdges[row + 1])) row++;
    return row * map.columns + column;
  };
  return { box, cell, at, x, y, plane };
}

/** Draws the ticks and names of a plane's components. */
export function drawPlaneAxes(g, frame, map) {
  const colors = themeColors();
  const { box, x, y, plane } = frame;
  g.fillStyle = colors.muted;
  g.strokeStyle = colors.muted;
  g.lineWidth = 1;
  for (const tick of ticks(map.xEdges[0], map.xEdges[map.columns], 5)) {
    g.textAlign = x(tick) > box.right - 10 ? "right" : x(tick) < box.left + 10 ? "left" : "center";
    g.fillText(number(tick, 3), x(tick), box.bottom + 13);
  }
  g.textAlign = "right";
  for (const tick of ticks(map.yEdges[map.rows], map.yEdges[0], 5)) g.fillText(number(tick, 3), box.left - 6, y(tick));
  g.fillText(named(plane.x), box.right, box.bottom + 29);
  g.textAlign = "left";
  g.fillText(named(plane.y), 2, 9);
}

function named({ name, unit }) {
  return unit ? `${name} (${unit})` : name;
}

const DIRECTIONS = { left: [-1, 0], right: [1, 0], up: [0, -1], down: [0, 1], west: [-1, 0], east: [1, 0], north: [0, -1], south: [0, 1], "-1": [-1, 0], "+1": [1, 0] };
const NO_ACTION = 255;
const MIN_ARROW_CELL = 13;
const HATCH = 6; // pixels between the lines of cells that were never visited

/** The direction of an action by the last word of its name; null without one, as for "no push" and "pick up". */
function direction(action) {
  const words = action.split(" ");
  return words.includes("no") || words.includes("pick") ? null : (DIRECTIONS[words.at(-1)] ?? null);
}

/** The letter of a cell; undefined without a layout. */
function letterAt(layout, cell) {
  const columns = layout?.[0].length;
  return layout?.[Math.floor(cell / columns)][cell % columns];
}

/** Whether the agent never chooses an action in a cell: the goal, a hole, or the cliff, which resets it. */
export function isEnd(layout, cell) {
  return layout !== null && "GHC".includes(letterAt(layout, cell));
}

/** Fills the cells: `share` gives a number from 0 to 1, NaN for a wall; those with `isUnvisited` are hatched. */
export function drawCells(g, frame, cells, palette, { share, isUnvisited, layout }) {
  const colors = themeColors();
  const hatched = new Path2D();
  for (let index = 0; index < cells; index++) {
    const { x, y, width, height } = frame.cell(index);
    if (letterAt(layout, index) === " ") continue;
    const part = share(index);
    const isBlank = isEnd(layout, index);
    const isHatched = !Number.isNaN(part) && !isBlank && isUnvisited(index);
    g.fillStyle = isBlank ? colors.line : Number.isNaN(part) ? colors.wall : isHatched ? colors.card : css(shade(palette, part));
    const gap = frame.plane ? 0 : 1;
    const [left, top] = frame.plane ? [Math.floor(x), Math.floor(y)] : [x, y];
    const wide = frame.plane ? Math.ceil(x + width) - left : width - gap;
    const tall = frame.plane ? Math.ceil(y + height) - top : height - gap;
    g.fillRect(left, top, wide, tall);
    if (isHatched) hatched.rect(left, top, wide, tall);
  }
  hatch(g, hatched, frame.box, colors);
}

/** Draws diagonal lines within a path. */
function hatch(g, path, { left, top, right, bottom }, colors) {
  g.save();
  g.clip(path);
  g.globalAlpha = 0.45;
  g.strokeStyle = colors.muted;
  g.lineWidth = 1;
  g.beginPath();
  for (let x = left - (bottom - top); x < right; x += HATCH) {
    g.moveTo(x, bottom);
    g.lineTo(x + bottom - top, top);
  }
  g.stroke();
  g.restore();
}

/** Draws the greedy actions of visited states as arrows, or a dot for an action without a direction; only some if cells are small. */
export function drawPolicy(g, frame, map, palette, { actions, greedy, share, isUnvisited, layout }) {
  const sample = frame.cell(0);
  const everyColumn = Math.max(Math.ceil(MIN_ARROW_CELL / sample.width), 1);
  const everyRow = Math.max(Math.ceil(MIN_ARROW_CELL / sample.height), 1);
  const directions = actions.map(direction);
  g.globalAlpha = 0.9;
  for (let row = Math.floor(everyRow / 2); row < map.rows; row += everyRow) {
    for (let column = Math.floor(everyColumn / 2); column < map.columns; column += everyColumn) {
      const index = row * map.columns + column;
      if (greedy[index] === NO_ACTION || Number.isNaN(share(index)) || isEnd(layout, index) || isUnvisited(index)) continue;
      const { x, y, width, height } = frame.cell(index);
      const size = Math.min(width * everyColumn, height * everyRow, 40) * 0.3;
      const towards = directions[greedy[index]];
      const ink = inkOn(shade(palette, share(index)));
      if (towards || frame.plane) arrow(g, x + width / 2, y + height / 2, size, towards, ink, 1.4);
      else drawInitial(g, x + width / 2, y + height / 2, size, actions[greedy[index]], ink);
    }
  }
  g.globalAlpha = 1;
}

/** Draws the first letter of an action that has no direction. */
function drawInitial(g, x, y, size, action, color) {
  g.font = `600 ${Math.max(size * 1.7, 8)}px ${FONT}`;
  g.textAlign = "center";
  g.fillStyle = color;
  g.fillText(action[0].toUpperCase(), x, y + 1);
  g.font = `12px ${FONT}`;
}

/** Draws the walls between the squares of the taxi's two boards. */
export function drawTaxiWalls(g, frame, columns) {
  for (const [row, column] of TAXI_WALLS) {
    for (const board of [0, (columns + 1) / 2]) {
      const { x, y, width, height } = frame.cell(row * columns + board + column);
      line(g, [[x + width - 0.5, y], [x + width - 0.5, y + height]], themeColors().ink, 3);
    }
  }
}

/**
 * Draws the letters of a grid world: S start, in its corner, like the stands of the taxi in lower case; and G goal, H
 * hole, C cliff, which have no value.
 */
export function drawLetters(g, frame, layout) {
  layout.join("").split("").forEach((letter, index) => {
    if (!"SGHCrgyb".includes(letter)) return;
    const { x, y, width } = frame.cell(index);
    const isLarge = "GHC".includes(letter);
    const size = isLarge ? Math.max(Math.min(width * 0.42, 17), 9) : Math.max(Math.min(width * 0.3, 13), 8);
    g.font = `700 ${size}px ${FONT}`;
    g.textAlign = "center";
    if (isLarge) {
      g.fillStyle = letter === "G" ? themeColors().good : themeColors().muted;
      g.fillText(letter, x + width / 2, y + width / 2);
      return;
    }
    disc(g, x + size * 0.9, y + size * 0.9, size * 0.75, "rgba(255, 255, 255, 0.88)");
    g.fillStyle = "#1f4f8f";
    g.fillText(letter.toUpperCase(), x + size * 0.9, y + size * 0.95);
  });
  g.font = `12px ${FONT}`;
}

/** Draws the rewards of a painted grid, [row, column, reward], below the arrows of their cells. */
export function drawRewards(g, frame, columns, rewards) {
  for (const [row, column, reward] of rewards) {
    const { x, y, width, height } = frame.cell(row * columns + column);
    const size = Math.max(Math.min(width * 0.3, 13), 8);
    const text = number(reward, 3);
    g.font = `700 ${size}px ${FONT}`;
    const wide = g.measureText(text).width + size * 0.6;
    roundBox(g, x + width / 2 - wide / 2, y + height - size * 1.25, wide, size * 1.2, size * 0.4, "rgba(255, 255, 255, 0.9)");
    g.fillStyle = reward < 0 ? "#a33c0c" : "#1b6b3a";
    g.textAlign = "center";
    g.fillText(text, x + width / 2, y + height - size * 0.6);
  }
  g.font = `12px ${FONT}`;
}

/** Draws a path through points, whose parts end at null, with a light edge, to be visible on every color, and a dot at its start. */
export function drawPath(g, frame, points) {
  if (!points.length) return;
  const { warm } = themeColors();
  g.save();
  g.beginPath();
  g.rect(frame.box.left, frame.box.top, frame.box.right - frame.box.left, frame.box.bottom - frame.box.top);
  g.clip();
  const thin = points.length > 250 ? 0.5 : 1;
  const parts = [[]];
  for (const point of points) {
    if (point === null) parts.push([]);
    else parts.at(-1).push(point);
  }
  for (const part of parts) {
    line(g, part, "rgba(255, 255, 255, 0.85)", 3.6 * thin);
    line(g, part, warm, 1.8 * thin);
  }
  dot(g, points[0], 4, warm);
  g.restore();
}

/** Outlines a cell. */
export function drawOutline(g, { x, y, width, height }) {
  const pad = width < 12 ? 1.5 : -1;
  for (const [color, thickness] of [["#ffffff", 4], ["#10151d", 2]]) {
    g.strokeStyle = color;
    g.lineWidth = thickness;
    g.strokeRect(x - pad, y - pad, width + 2 * pad - 1, height + 2 * pad - 1);
  }
}
