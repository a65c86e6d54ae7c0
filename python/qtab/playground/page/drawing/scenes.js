// Scenes of the agent in motion: the mountain car and the cart with its pole as Gymnasium draws them, and grid worlds.

import { arrow, disc, dot, line, polygon, roundBox } from "./shapes.js";
import { FONT, scale } from "./surface.js";
import { themeColors } from "./theme.js";

const [LEFT_WALL, RIGHT_WALL, FLAG] = [-1.2, 0.6, 0.5];
const hill = (position) => Math.sin(3 * position) * 0.45 + 0.55;

export const mountainCar = {
  stepsPerSecond: 30,

  draw(g, width, height, { observation, action }) {
    const colors = themeColors();
    const x = scale(LEFT_WALL, RIGHT_WALL, 0, width);
    const y = scale(0, 1.25, height * 0.93, height * 0.06);
    g.fillStyle = colors.sky;
    g.fillRect(0, 0, width, height);
    drawHill(g, width, height, x, y, colors);
    drawFlag(g, x(FLAG), y(hill(FLAG)), height * 0.2, colors);
    const [position] = observation;
    const unitX = width / (RIGHT_WALL - LEFT_WALL);
    const unitY = (height * 0.87) / 1.25;
    g.save();
    g.translate(x(position), y(hill(position)));
    g.rotate(-Math.atan2(Math.cos(3 * position) * 3 * 0.45 * unitY, unitX));
    drawCar(g, Math.max(width / 15, 26), colors);
    g.restore();
    if (action === null) return;
    arrow(g, x(position), y(hill(position)) - width / 10, width / 40, [[-1, 0], null, [1, 0]][action], colors.warm, 3);
  },

  outcome: () => "it reached the flag",

  alternative: ({ observation }) => `the car is at position ${observation[0].toFixed(2)}`,
};

function drawHill(g, width, height, x, y, colors) {
  const surface = [];
  for (let place = LEFT_WALL; place <= RIGHT_WALL + 0.005; place += 0.01) surface.push([x(place), y(hill(place))]);
  polygon(g, [[0, height], ...surface, [width, height]], colors.ground);
  line(g, surface, colors.muted, 2);
}

function drawFlag(g, x, y, size, colors) {
  line(g, [[x, y], [x, y - size]], colors.ink, 2);
  polygon(g, [[x, y - size], [x + size * 0.38, y - size * 0.78], [x, y - size * 0.56]], colors.good);
}

/** Draws a car whose wheels stand on the origin. */
function drawCar(g, length, colors) {
  const wheel = length * 0.16;
  roundBox(g, -length / 2, -wheel * 1.2 - length * 0.3, length, length * 0.3, length * 0.06, colors.accent);
  const [roof, doors] = [-wheel * 1.2 - length * 0.52, -wheel * 1.2 - length * 0.28];
  polygon(g, [[-length * 0.3, doors], [-length * 0.18, roof], [length * 0.16, roof], [length * 0.32, doors]], colors.accent);
  for (const place of [-0.28, 0.28]) {
    disc(g, place * length, -wheel, wheel, colors.ink);
    disc(g, place * length, -wheel, wheel * 0.4, colors.card);
  }
}

const LIMIT = 2.4;

export const cartPole = {
  stepsPerSecond: 50,

  draw(g, width, height, { observation, action }) {
    const colors = themeColors();
    const [position, , angle] = observation;
    const x = scale(-LIMIT * 1.2, LIMIT * 1.2, 0, width);
    const ground = height * 0.8;
    g.fillStyle = colors.sky;
    g.fillRect(0, 0, width, height);
    g.fillStyle = colors.ground;
    g.fillRect(0, ground, width, height - ground);
    line(g, [[0, ground], [width, ground]], colors.muted, 2);
    g.setLineDash([4, 5]);
    for (const limit of [-LIMIT, LIMIT]) line(g, [[x(limit), ground], [x(limit), ground - 60]], colors.muted, 1.5);
    g.setLineDash([]);
    const [length, tall] = [width / 9, width / 17];
    const pivot = [x(position), ground - tall * 0.95];
    roundBox(g, pivot[0] - length / 2, ground - tall, length, tall * 0.72, 4, colors.accent);
    for (const side of [-0.3, 0.3]) disc(g, pivot[0] + side * length, ground - tall * 0.18, tall * 0.18, colors.ink);
    const [pole, thickness] = [height * 0.5, Math.max(width / 70, 5)];
    const tip = [pivot[0] + Math.sin(angle) * pole, pivot[1] - Math.cos(angle) * pole];
    line(g, [pivot, tip], colors.warm, thickness);
    disc(g, ...pivot, thickness * 0.6, colors.ink);
    if (action === null) return;
    const side = action ? 1 : -1;
    arrow(g, pivot[0] + side * length * 0.85, ground - tall * 0.62, width / 45, [side, 0], colors.warm, 3);
  },

  outcome: ({ observation }) => (Math.abs(observation[0]) > LIMIT ? "the cart left the track" : "the pole fell"),

  alternative: ({ observation }) =>
    `the cart is at ${observation[0].toFixed(2)} m, the pole leans by ${((observation[2] * 180) / Math.PI).toFixed(1)} degrees`,
};

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
    g.globalAlpha = 0.65;
    if (trail.length > 1) line(g, trail.map(center), colors.warm, Math.max(size * 0.07, 2));
    g.globalAlpha = 1;
    if (cell === null) return;
    const [fromX, fromY] = center(from ?? cell);
    const [toX, toY] = center(cell);
    dot(g, [fromX + (toX - fromX) * share, fromY + (toY - fromY) * share], size * 0.24, colors.accent);
  },

  outcome: ({ layout, cell }) => {
    const columns = layout[0].length;
    return layout[Math.floor(cell / columns)][cell % columns] === "H" ? "it fell into a hole" : "it reached the goal";
  },

  alternative: ({ layout, cell }) => {
    if (cell === null) return "it has not begun yet";
    const columns = layout[0].length;
    return `the agent is in row ${Math.floor(cell / columns) + 1}, column ${(cell % columns) + 1}`;
  },
};

function drawFloor(g, x, y, size, letter, drawing, colors) {
  const floor = FLOORS[drawing];
  const special = { "#": colors.wall, C: colors.isDark ? "#6b3a28" : "#b5694a" };
  const color = special[letter] ?? (colors.isDark ? floor.dark : floor.light);
  roundBox(g, x + 1, y + 1, size - 2, size - 2, Math.min(size * 0.12, 6), color);
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
  g.globalAlpha = 0.4;
  for (let index = 0; index < Math.min(Math.abs(strength), 3); index++) {
    const at = y + size * (0.34 + index * 0.2);
    const tip = strength > 0 ? -size * 0.1 : size * 0.1;
    line(g, [[x + size * 0.36, at], [x + size * 0.5, at + tip], [x + size * 0.64, at]], colors.muted, 1.2);
  }
  g.globalAlpha = 1;
}

function drawReward(g, x, y, size, reward, colors) {
  g.font = `600 ${Math.max(Math.min(size * 0.32, 15), 8)}px ${FONT}`;
  g.textAlign = "center";
  g.fillStyle = reward < 0 ? colors.warm : colors.good;
  g.fillText(`${reward > 0 ? "+" : reward < 0 ? "−" : ""}${Math.abs(reward)}`, x, y);
  g.font = `12px ${FONT}`;
}
