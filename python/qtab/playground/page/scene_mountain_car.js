// The mountain car as Gymnasium draws it: the hill sin(3x), the flag, the car and the direction of its push.

import { drawArrow } from "./map_drawing.js";
import { scale } from "./surface.js";
import { themeColors } from "./theme.js";

const [LEFT_WALL, RIGHT_WALL, FLAG] = [-1.2, 0.6, 0.5];
const hill = (position) => Math.sin(3 * position) * 0.45 + 0.55;

export const mountainCar = {
  stepsPerSecond: 30,
  aspect: 16 / 9,

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
    if (action !== null) {
      g.strokeStyle = colors.warm;
      g.fillStyle = colors.warm;
      g.lineWidth = 3;
      drawArrow(g, x(position), y(hill(position)) - width / 10, width / 40, [[-1, 0], null, [1, 0]][action]);
    }
  },

  alternative: ({ observation }) => `the car is at position ${observation[0].toFixed(2)}`,
};

function drawHill(g, width, height, x, y, colors) {
  g.beginPath();
  g.moveTo(0, height);
  for (let place = LEFT_WALL; place <= RIGHT_WALL + 0.005; place += 0.01) g.lineTo(x(place), y(hill(place)));
  g.lineTo(width, height);
  g.fillStyle = colors.ground;
  g.fill();
  g.beginPath();
  for (let place = LEFT_WALL; place <= RIGHT_WALL + 0.005; place += 0.01) g.lineTo(x(place), y(hill(place)));
  g.strokeStyle = colors.muted;
  g.lineWidth = 2;
  g.stroke();
}

export function drawFlag(g, x, y, size, colors) {
  g.strokeStyle = colors.ink;
  g.lineWidth = 2;
  g.beginPath();
  g.moveTo(x, y);
  g.lineTo(x, y - size);
  g.stroke();
  g.fillStyle = colors.good;
  g.beginPath();
  g.moveTo(x, y - size);
  g.lineTo(x + size * 0.38, y - size * 0.78);
  g.lineTo(x, y - size * 0.56);
  g.fill();
}

/** Draws a car whose wheels stand on the origin. */
function drawCar(g, length, colors) {
  const wheel = length * 0.16;
  g.fillStyle = colors.accent;
  g.beginPath();
  g.roundRect(-length / 2, -wheel * 1.2 - length * 0.3, length, length * 0.3, length * 0.06);
  g.fill();
  g.beginPath();
  g.moveTo(-length * 0.3, -wheel * 1.2 - length * 0.28);
  g.lineTo(-length * 0.18, -wheel * 1.2 - length * 0.52);
  g.lineTo(length * 0.16, -wheel * 1.2 - length * 0.52);
  g.lineTo(length * 0.32, -wheel * 1.2 - length * 0.28);
  g.fill();
  for (const place of [-0.28, 0.28]) {
    g.beginPath();
    g.arc(place * length, -wheel, wheel, 0, 2 * Math.PI);
    g.fillStyle = colors.ink;
    g.fill();
    g.beginPath();
    g.arc(place * length, -wheel, wheel * 0.4, 0, 2 * Math.PI);
    g.fillStyle = colors.card;
    g.fill();
  }
}
