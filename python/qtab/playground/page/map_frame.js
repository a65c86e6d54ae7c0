// The positions of a map's cells on its canvas, and its axes: a plane of two components, or the cells of a grid.

import { number } from "./format.js";
import { scale, ticks } from "./surface.js";
import { themeColors } from "./theme.js";

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
