// The cart and its pole, with the limits of its track.

import { drawArrow } from "./map_drawing.js";
import { scale } from "./surface.js";
import { themeColors } from "./theme.js";

const LIMIT = 2.4;

export const cartPole = {
  stepsPerSecond: 50,
  aspect: 16 / 9,

  draw(g, width, height, { observation, action }) {
    const colors = themeColors();
    const [position, , angle] = observation;
    const x = scale(-LIMIT * 1.2, LIMIT * 1.2, 0, width);
    const ground = height * 0.8;
    g.fillStyle = colors.sky;
    g.fillRect(0, 0, width, height);
    g.fillStyle = colors.ground;
    g.fillRect(0, ground, width, height - ground);
    g.strokeStyle = colors.muted;
    g.lineWidth = 2;
    g.beginPath();
    g.moveTo(0, ground);
    g.lineTo(width, ground);
    g.stroke();
    drawLimits(g, x, ground, colors);
    const [length, tall] = [width / 9, width / 17];
    const pivot = [x(position), ground - tall * 0.95];
    g.fillStyle = colors.accent;
    g.beginPath();
    g.roundRect(pivot[0] - length / 2, ground - tall, length, tall * 0.72, 4);
    g.fill();
    g.fillStyle = colors.ink;
    for (const side of [-0.3, 0.3]) {
      g.beginPath();
      g.arc(pivot[0] + side * length, ground - tall * 0.18, tall * 0.18, 0, 2 * Math.PI);
      g.fill();
    }
    drawPole(g, pivot, angle, height * 0.5, Math.max(width / 70, 5), colors);
    if (action !== null) {
      g.strokeStyle = colors.warm;
      g.fillStyle = colors.warm;
      g.lineWidth = 3;
      const side = action ? 1 : -1;
      drawArrow(g, pivot[0] + side * length * 0.85, ground - tall * 0.62, width / 45, [side, 0]);
    }
  },

  alternative: ({ observation }) =>
    `the cart is at ${observation[0].toFixed(2)} m, the pole leans by ${((observation[2] * 180) / Math.PI).toFixed(1)} degrees`,
};

function drawPole(g, [left, top], angle, length, width, colors) {
  g.strokeStyle = colors.warm;
  g.lineWidth = width;
  g.beginPath();
  g.moveTo(left, top);
  g.lineTo(left + Math.sin(angle) * length, top - Math.cos(angle) * length);
  g.stroke();
  g.fillStyle = colors.ink;
  g.beginPath();
  g.arc(left, top, width * 0.6, 0, 2 * Math.PI);
  g.fill();
}

function drawLimits(g, x, ground, colors) {
  g.setLineDash([4, 5]);
  g.lineWidth = 1.5;
  for (const limit of [-LIMIT, LIMIT]) {
    g.beginPath();
    g.moveTo(x(limit), ground);
    g.lineTo(x(limit), ground - 60);
    g.strokeStyle = colors.muted;
    g.stroke();
  }
  g.setLineDash([]);
}
