// The environments to choose from, each with a small drawing.

const SVG = "http://www.w3.org/2000/svg";
const STROKE = 'fill="none" stroke="currentColor" stroke-width="2" stroke-linecap="round" stroke-linejoin="round"';
const cells = (filled) =>
  filled.map(([x, y]) => `<rect x="${6 + x * 8}" y="${y * 8}" width="7" height="7" rx="1.2" fill="currentColor" opacity=".85"/>`).join("");
const board = (columns, rows) =>
  Array.from({ length: columns * rows }, (_, index) => {
    const [x, y] = [6 + (index % columns) * 8, Math.floor(index / columns) * 8];
    return `<rect x="${x}" y="${y}" width="7" height="7" rx="1.2" fill="currentColor" opacity=".2"/>`;
  }).join("");
const DRAWINGS = {
  mountain_car: `<path d="M2 6 C8 12 12 29 20 29 C28 29 32 8 41 5" ${STROKE}/><path d="M41 5v-5l-6 2.5 6 2.5" fill="currentColor"/><circle cx="20" cy="25" r="3.4" fill="currentColor"/>`,
  cart_pole: `<path d="M2 29h40" ${STROKE}/><rect x="13" y="21" width="18" height="7" rx="2" fill="currentColor"/><path d="M22 21 L28 2" ${STROKE}/>`,
  frozen_lake: board(4, 4) + '<circle cx="17.500" cy="11.500" r="3" fill="currentColor"/><circle cx="33.500" cy="11.500" r="3" fill="currentColor"/><circle cx="33.500" cy="19.500" r="3" fill="currentColor"/>',
  cliff: board(4, 4) + cells([[1, 3], [2, 3]]),
  windy: `<path d="M10 30V12m-4 4 4-4 4 4M22 30V4m-4 4 4-4 4 4M34 30V12m-4 4 4-4 4 4" ${STROKE}/>`,
  grid: board(4, 4) + cells([[1, 0], [1, 1], [2, 1], [2, 3]]),
};

function drawing(key, entry) {
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("viewBox", "0 0 44 32");
  svg.setAttribute("aria-hidden", "true");
  svg.innerHTML = DRAWINGS[key === "WindyGridWorld" ? "windy" : entry.drawing] ?? DRAWINGS.grid;
  return svg;
}

/** Shows the environments as radio buttons with arrow keys, and the title and sentence of the chosen one. */
export function setUpEnvironments(store, group, title, sentence) {
  const entries = Object.entries(store.definitions.environments);
  const buttons = entries.map(([key, entry]) => {
    const button = Object.assign(document.createElement("button"), { type: "button" });
    button.setAttribute("role", "radio");
    button.dataset.environment = key;
    button.append(drawing(key, entry), entry.title);
    button.addEventListener("click", () => store.choose(key));
    return button;
  });
  group.append(...buttons);
  moveWithArrows(group, (button) => button.click());
  const show = ({ environment }) => {
    for (const button of buttons) {
      const chosen = button.dataset.environment === environment;
      button.setAttribute("aria-checked", chosen);
      button.tabIndex = chosen ? 0 : -1;
    }
    const chosen = buttons.find((button) => button.dataset.environment === environment);
    group.scrollLeft = Math.max(chosen.offsetLeft - group.offsetLeft - group.clientWidth / 3, 0);
    title.textContent = store.entry.title;
    sentence.textContent = store.entry.sentence;
  };
  store.subscribe((state) => show(state));
  show(store.state);
}

/** Makes the arrow keys move between the radio buttons of a group, and select them. */
export function moveWithArrows(group, choose) {
  group.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (!step) return;
    const buttons = [...group.querySelectorAll('[role="radio"]:not(:disabled)')];
    const at = buttons.indexOf(document.activeElement);
    if (at < 0) return;
    event.preventDefault();
    const next = buttons[(at + step + buttons.length) % buttons.length];
    next.focus();
    choose(next);
  });
}
