// Grid worlds: the frozen lake, the cliff, the windy grid and painted ones, with the agent and its trail.

import { drawDot } from "./map_drawing.js";
import { drawFlag } from "./scene_mountain_car.js";
import { FONT } from "./surface.js";
import { themeColors } from "./theme.js";

const FLOORS = {
  frozen_lake: { light: "#dcebf5", dark: "#2b4252" },
  cliff: { light: "#e6ebda", dark: "#333c2b" },
  grid: { light: "#f0efe9", dark: "#2a2f38" },
};

export const gridWorld = {
  stepsPerSecond: 5,

  /** `layout`: rows of letters; `wind`: the shift of each column or null; `cell`, `from`: the agent's cell and its last one. */
  draw(g, width, height, { layout, wind, rewards, drawing, cell, from, share, trail }) {
    const colors = themeColors();
    const columns = layout[0].length;
    const size = Math.min(width / columns, height / layout.length);
    const [left, top] = [(width - size * columns) / 2, (height - size * layout.length) / 2];
    const center = (index) => [left + ((index % columns) + 0.5) * size, top + (Math.floor(index / columns) + 0.5) * size];
    layout.forEach((line, row) => {
      [...line].forEach((letter, column) => {
        drawFloor(g, left + column * size, top + row * size, size, letter, drawing, colors);
        if (wind?.[column] && letter !== "#") drawWind(g, left + column * size, top + row * size, size, wind[column], colors);
      });
    });
    for (const [row, column, reward] of rewards ?? []) {
      drawReward(g, ...center(row * columns + column), size, reward, colors);
    }
    drawTrail(g, trail.map(center), size, colors);
    if (cell === null) return;
    const [fromX, fromY] = center(from ?? cell);
    const [toX, toY] = center(cell);
    drawDot(g, [fromX + (toX - fromX) * share, fromY + (toY - fromY) * share], size * 0.24, colors.accent);
  },

  alternative: ({ layout, cell }) => {
    if (cell === null) return "it has not begun yet";
    const columns = layout[0].length;
    return `the agent is in row ${Math.floor(cell / columns) + 1}, column ${(cell % columns) + 1}`;
  },
};

function drawFloor(g, x, y, size, letter, drawing, colors) {
  const floor = FLOORS[drawing] ?? FLOORS.grid;
  g.fillStyle = colors.isDark ? floor.dark : floor.light;
  if (letter === "#") g.fillStyle = colors.wall;
  if (letter === "C") g.fillStyle = colors.isDark ? "#6b3a28" : "#b5694a";
  g.beginPath();
  g.roundRect(x + 1, y + 1, size - 2, size - 2, Math.min(size * 0.12, 6));
  g.fill();
  if (letter === "H") {
    g.fillStyle = colors.isDark ? "#0d1a24" : "#35637f";
    g.beginPath();
    g.ellipse(x + size / 2, y + size / 2, size * 0.34, size * 0.3, 0, 0, 2 * Math.PI);
    g.fill();
  } else if (letter === "G") {
    drawFlag(g, x + size * 0.4, y + size * 0.84, size * 0.68, colors);
  } else if (letter === "S") {
    g.strokeStyle = colors.accent;
    g.lineWidth = Math.max(size * 0.05, 1.5);
    g.beginPath();
    g.arc(x + size / 2, y + size / 2, size * 0.3, 0, 2 * Math.PI);
    g.stroke();
  }
}

function drawWind(g, x, y, size, strength, colors) {
  g.strokeStyle = colors.muted;
  g.globalAlpha = 0.4;
  g.lineWidth = 1.2;
  for (let index = 0; index < Math.min(Math.abs(strength), 3); index++) {
    const at = y + size * (0.34 + index * 0.2);
    const tip = strength > 0 ? -size * 0.1 : size * 0.1;
    g.beginPath();
    g.moveTo(x + size * 0.36, at);
    g.lineTo(x + size * 0.5, at + tip);
    g.lineTo(x + size * 0.64, at);
    g.stroke();
  }
  g.globalAlpha = 1;
}

export function drawReward(g, x, y, size, reward, colors) {
  g.font = `600 ${Math.max(Math.min(size * 0.32, 15), 8)}px ${FONT}`;
  g.textAlign = "center";
  g.fillStyle = reward < 0 ? colors.warm : colors.good;
  g.fillText(`${reward > 0 ? "+" : reward < 0 ? "−" : ""}${Math.abs(reward)}`, x, y);
  g.font = `12px ${FONT}`;
}

function drawTrail(g, points, size, colors) {
  if (points.length < 2) return;
  g.strokeStyle = colors.warm;
  g.globalAlpha = 0.65;
  g.lineWidth = Math.max(size * 0.07, 2);
  g.beginPath();
  points.forEach(([x, y], index) => (index ? g.lineTo(x, y) : g.moveTo(x, y)));
  g.stroke();
  g.globalAlpha = 1;
}
