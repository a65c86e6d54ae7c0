// Scenes of the taxi and of blackjack, and their states in words.

import { disc, line, roundBox } from "./shapes.js";
import { FONT } from "./surface.js";
import { themeColors } from "./theme.js";

/** The squares of a board of the taxi along a side. Two boards with a gap are beside each other on the map of values. */
const SIZE = 5;
const IN_TAXI = 4;
/** The stands: row, column, name and color. */
const STANDS = [[0, 0, "R", "#c4362b"], [0, 4, "G", "#2c8a4b"], [4, 0, "Y", "#b58900"], [4, 3, "B", "#2f6fc0"]];
/** Rows and columns of the squares with a wall to their right. */
export const TAXI_WALLS = [[0, 1], [1, 1], [3, 0], [3, 2], [4, 0], [4, 2]];

const rideOf = (state) => ({ destination: state % 4, location: Math.floor(state / 4) % 5 });

export const taxi = {
  stepsPerSecond: 3,

  draw(g, width, height, { observation, cell, from, share, layout }) {
    const colors = themeColors();
    const size = Math.min(width, height) / SIZE;
    const [left, top] = [(width - SIZE * size) / 2, (height - SIZE * size) / 2];
    const columns = layout[0].length;
    const squareOf = (index) => [Math.floor(index / columns), (index % columns) % (SIZE + 1)];
    const center = ([row, column]) => [left + (column + 0.5) * size, top + (row + 0.5) * size];
    const floor = colors.isDark ? "#2a2f38" : "#f0efe9";
    for (let index = 0; index < SIZE * SIZE; index++) {
      roundBox(g, left + (index % SIZE) * size + 1, top + Math.floor(index / SIZE) * size + 1, size - 2, size - 2, 4, floor);
    }
    for (const [row, column] of TAXI_WALLS) {
      const x = left + (column + 1) * size;
      line(g, [[x, top + row * size], [x, top + (row + 1) * size]], colors.wall, 4);
    }
    for (const stand of STANDS) drawStand(g, ...center(stand), size, stand);
    if (cell === null) return;
    const { destination, location } = rideOf(observation[0]);
    const [x, y] = center(STANDS[destination]);
    g.strokeStyle = STANDS[destination][3];
    g.lineWidth = 3;
    g.strokeRect(x - size * 0.42, y - size * 0.42, size * 0.84, size * 0.84);
    const [start, end] = [squareOf(from ?? cell), squareOf(cell)].map(center);
    const place = start.map((each, axis) => each + (end[axis] - each) * share);
    drawTaxi(g, ...place, size, colors);
    if (location === IN_TAXI) disc(g, place[0], place[1] - size * 0.06, size * 0.09, colors.ink);
    else disc(g, center(STANDS[location])[0] + size * 0.26, center(STANDS[location])[1] + size * 0.22, size * 0.12, colors.ink);
  },

  outcome: () => "the passenger arrived",

  alternative: ({ observation, cell, layout }) => {
    if (cell === null) return "it has not begun yet";
    const { destination, location } = rideOf(observation[0]);
    const where = location === IN_TAXI ? "in the taxi" : `at stand ${STANDS[location][2]}`;
    return `${stateWords("taxi", cell, layout[0].length)}, the passenger is ${where} and wants to go to ${STANDS[destination][2]}`;
  },
};

function drawStand(g, x, y, size, [, , name, color]) {
  g.globalAlpha = 0.25;
  roundBox(g, x - size / 2 + 1, y - size / 2 + 1, size - 2, size - 2, 4, color);
  g.globalAlpha = 1;
  g.font = `700 ${Math.max(size * 0.26, 10)}px ${FONT}`;
  g.textAlign = "left";
  g.fillStyle = color;
  g.fillText(name, x - size * 0.36, y - size * 0.26);
  g.font = `12px ${FONT}`;
}

function drawTaxi(g, x, y, size, colors) {
  roundBox(g, x - size * 0.26, y - size * 0.06, size * 0.52, size * 0.2, size * 0.05, "#e0a800");
  roundBox(g, x - size * 0.15, y - size * 0.18, size * 0.3, size * 0.16, size * 0.05, "#e0a800");
  for (const side of [-0.15, 0.15]) disc(g, x + side * size, y + size * 0.15, size * 0.07, colors.ink);
}

/** The player's sum, the dealer's card and whether the player has a usable ace, of a numbered state. */
const handOf = (state) => ({ sum: Math.floor(state / 22), card: Math.floor(state / 2) % 11, ace: state % 2 });
const cardName = (card) => (card === 1 ? "A" : String(card));

export const blackjack = {
  stepsPerSecond: 0.8,

  draw(g, width, height, { observation, action }) {
    const colors = themeColors();
    g.fillStyle = colors.isDark ? "#1d3a2c" : "#dcebe1";
    g.fillRect(0, 0, width, height);
    if (!observation) return;
    const { sum, card, ace } = handOf(observation[0]);
    const tall = height * 0.46;
    drawCard(g, width * 0.3, height * 0.48, tall, String(sum), sum > 21 ? colors.warm : colors.ink, colors);
    drawCard(g, width * 0.7, height * 0.48, tall, cardName(card), colors.ink, colors);
    g.fillStyle = colors.ink;
    g.textAlign = "center";
    g.font = `600 13px ${FONT}`;
    g.fillText(ace ? "sum, with a usable ace" : "sum", width * 0.3, height * 0.14);
    g.fillText("the dealer shows", width * 0.7, height * 0.14);
    g.fillStyle = colors.warm;
    g.font = `700 17px ${FONT}`;
    if (action !== null) g.fillText(["stick", "hit"][action], width * 0.3, height * 0.86);
    g.font = `12px ${FONT}`;
  },

  outcome: ({ observation }, { return: earned }) =>
    handOf(observation[0]).sum > 21 ? "it went over 21" : earned > 0 ? "it won" : earned < 0 ? "the dealer won" : "a draw",

  alternative: ({ observation }) => {
    if (!observation) return "it has not begun yet";
    const { sum, card, ace } = handOf(observation[0]);
    return `the sum is ${sum}, ${ace ? "with" : "without"} a usable ace, and the dealer shows ${cardName(card)}`;
  },
};

function drawCard(g, x, y, tall, text, color, colors) {
  roundBox(g, x - tall * 0.35, y - tall / 2, tall * 0.7, tall, tall * 0.08, colors.card);
  g.strokeStyle = colors.line;
  g.lineWidth = 1;
  g.stroke();
  g.fillStyle = color;
  g.textAlign = "center";
  g.font = `700 ${tall * 0.34}px ${FONT}`;
  g.fillText(text, x, y);
}

/** The state of a cell on a map of values in words. */
export function stateWords(drawing, cell, columns) {
  const [row, column] = [Math.floor(cell / columns), cell % columns];
  if (drawing === "taxi") {
    const when = column > SIZE ? "with the passenger" : "before the pick-up";
    return `the taxi is in row ${row}, column ${column % (SIZE + 1)}, ${when}`;
  }
  if (drawing === "blackjack") return `sum ${21 - row}, ${column > 10 ? "with" : "without"} a usable ace, the dealer shows ${cardName((column % 11) + 1)}`;
  return `row ${row}, column ${column}`;
}
