// The scene of the acrobot: two links, the line to reach, and the torque between the links.

import { disc, line } from "./shapes.js";
import { themeColors } from "./theme.js";

/** The height of the line above the upper joint; each link is 1 long. */
const GOAL = 1;
const REACH = 2.25;

/** The ends of both links from the upper joint, to the right and up. */
function endsOf([cos1, sin1, cos2, sin2]) {
  const middle = [sin1, -cos1];
  return [middle, [middle[0] + sin1 * cos2 + cos1 * sin2, middle[1] - cos1 * cos2 + sin1 * sin2]];
}

export const acrobot = {
  stepsPerSecond: 12,

  draw(g, width, height, { observation, action }) {
    const colors = themeColors();
    const size = Math.min(width, height) / 2 / REACH;
    const at = ([right, up]) => [width / 2 + right * size, height / 2 - up * size];
    g.fillStyle = colors.sky;
    g.fillRect(0, 0, width, height);
    const [, goal] = at([0, GOAL]);
    g.setLineDash([6, 5]);
    line(g, [[0, goal], [width, goal]], colors.good, 2);
    g.setLineDash([]);
    g.fillStyle = colors.good;
    g.textAlign = "left";
    g.fillText("goal", 8, goal - 9);
    const joint = at([0, 0]);
    const [middle, end] = endsOf(observation).map(at);
    g.lineCap = "round";
    line(g, [joint, middle], colors.accent, size * 0.2);
    line(g, [middle, end], colors.warm, size * 0.2);
    g.lineCap = "butt";
    for (const place of [joint, middle]) disc(g, ...place, size * 0.07, colors.ink);
    if (action === 0 || action === 2) drawTorque(g, middle, size * 0.4, action === 2, colors.ink);
  },

  outcome: () => "the end rose above the line",

  alternative: ({ observation }) => `the end of the links is at height ${endsOf(observation)[1][1].toFixed(2)}, the line at ${GOAL}`,
};

/** Draws an arrow around a joint, the way in which the torque turns the second link. */
function drawTorque(g, [x, y], radius, isCounterclockwise, color) {
  const turn = isCounterclockwise ? -1 : 1;
  const [from, to] = [0.75 * turn, 2.6 * turn].map((angle) => angle - Math.PI / 2);
  g.strokeStyle = color;
  g.lineWidth = 2.5;
  g.beginPath();
  g.arc(x, y, radius, from, to, isCounterclockwise);
  g.stroke();
  const tip = [x + radius * Math.cos(to), y + radius * Math.sin(to)];
  const head = (angle) => [tip[0] - radius * 0.5 * Math.cos(angle), tip[1] - radius * 0.5 * Math.sin(angle)];
  const ahead = to + (turn * Math.PI) / 2;
  line(g, [head(ahead - 0.3), tip, head(ahead + 0.9 * -turn)], color, 2.5);
}
