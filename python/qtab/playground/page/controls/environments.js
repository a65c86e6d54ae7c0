// The environments to choose from, each with a small drawing.

import { radioButtons } from "./elements.js";
import { exampleState } from "./examples.js";
import { isWeighted } from "../format.js";

const STROKE = 'fill="none" stroke="currentColor" stroke-width="2" stroke-linecap="round" stroke-linejoin="round"';
const cell = (x, y, opacity, size = 8) =>
  `<rect x="${6 + x * size}" y="${y * size}" width="${size - 1}" height="${size - 1}" rx="1.2" fill="currentColor" opacity="${opacity}"/>`;
const cells = (filled) => filled.map(([x, y]) => cell(x, y, ".85")).join("");
const board = (side) => Array.from({ length: side ** 2 }, (_, index) => cell(index % side, Math.floor(index / side), ".2", 32 / side)).join("");
const BOARD = board(4);
const hole = (x, y, size) => `<circle cx="${5.5 + (x + 0.5) * size}" cy="${(y + 0.5) * size - 0.5}" r="${size * 0.375}" fill="currentColor"/>`;
const holes = (places, size) => places.map(([x, y]) => hole(x, y, size)).join("");
const SMALL_LAKE = BOARD + holes([[1, 1], [3, 1], [3, 2], [0, 3]], 8);
const LARGE_LAKE = board(8) + holes([[3, 2], [5, 3], [3, 4], [1, 5], [2, 5], [6, 5], [1, 6], [4, 6], [6, 6], [3, 7]], 4);
// Curved lines on both sides of slippery ice.
const SLIPPERY = `<path d="M1 9q2-3 0-6t0-3M42 31q-2-3 0-6t0-6" ${STROKE}/>`;
const DRAWINGS = {
  mountain_car: `<path d="M2 6 C8 12 12 29 20 29 C28 29 32 8 41 5" ${STROKE}/><path d="M41 5v-5l-6 2.5 6 2.5" fill="currentColor"/><circle cx="20" cy="25" r="3.4" fill="currentColor"/>`,
  cart_pole: `<path d="M2 29h40" ${STROKE}/><rect x="13" y="21" width="18" height="7" rx="2" fill="currentColor"/><path d="M22 21 L28 2" ${STROKE}/>`,
  acrobot: `<path d="M3 6h38" ${STROKE} stroke-dasharray="1 5"/><path d="M22 13L33 19L25 29" ${STROKE}/><circle cx="22" cy="13" r="3" fill="currentColor"/><circle cx="33" cy="19" r="2.500" fill="currentColor"/>`,
  cliff: BOARD + cells([[1, 3], [2, 3]]),
  taxi: `<path d="M4 24h36v-7l-7-2-5-8H16l-5 8-7 2z" fill="currentColor" opacity=".85"/><circle cx="13" cy="25" r="4" fill="currentColor"/><circle cx="31" cy="25" r="4" fill="currentColor"/>`,
  blackjack: `<rect x="8" y="3" width="17" height="24" rx="2.500" ${STROKE}/><rect x="19" y="6" width="17" height="24" rx="2.500" fill="currentColor" opacity=".8"/>`,
  windy: `<path d="M10 30V12m-4 4 4-4 4 4M22 30V4m-4 4 4-4 4 4M34 30V12m-4 4 4-4 4 4" ${STROKE}/>`,
  grid: BOARD + cells([[1, 0], [1, 1], [2, 1], [2, 3]]),
};

/** The drawing of a lake shows its size, and whether it is slippery. */
function lake({ layout, env_kwargs }) {
  return (layout.length > 4 ? LARGE_LAKE : SMALL_LAKE) + (env_kwargs.is_slippery === false ? "" : SLIPPERY);
}

function drawing(key, entry) {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 44 32");
  svg.setAttribute("aria-hidden", "true");
  svg.innerHTML = entry.drawing === "frozen_lake" ? lake(entry) : DRAWINGS[key === "WindyGridWorld" ? "windy" : entry.drawing];
  return svg;
}

/** Shows the environments as radio buttons, the title and sentence of the chosen one, and whether Python learns the same. */
export function setUpEnvironments(store, group, title, sentence) {
  const choices = Object.entries(store.definitions.environments).map(([key, entry]) => [key, drawing(key, entry), entry.title]);
  const mark = radioButtons(group, "environment", choices, (key) => store.update(exampleState(store, key, 0)));
  const show = ({ environment, settings }) => {
    const chosen = mark(environment);
    const claim = store.entry.chaotic ? "chaotic" : isWeighted(settings) ? "close" : "equal";
    group.scrollLeft = Math.max(chosen.offsetLeft - group.offsetLeft - group.clientWidth / 3, 0);
    title.textContent = store.entry.title;
    sentence.textContent = store.entry.sentence;
    for (const each of document.querySelectorAll("[data-claim]")) each.hidden = each.dataset.claim !== claim;
  };
  store.subscribe(show);
  show(store.state);
}
