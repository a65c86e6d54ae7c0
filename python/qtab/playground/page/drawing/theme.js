// Light and dark colors, which the reader's system decides unless the button overrides it, and color maps for numbers.

const CHOICES = ["system", "light", "dark"];
const NAMES = { system: "System colors", light: "Light colors", dark: "Dark colors" };
const changed = new Set();
let colors = null;

/** The current theme: "light" or "dark". */
function shownTheme() {
  const chosen = document.documentElement.dataset.theme;
  if (chosen === "light" || chosen === "dark") return chosen;
  return matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
}

/** The colors of style.css by their names without dashes, for canvases. */
export function themeColors() {
  if (!colors) {
    // The computed value of a variable is its text, with both colors; that of `color` is the one shown.
    const probe = document.body.appendChild(document.createElement("i"));
    const shown = getComputedStyle(probe);
    const colorOf = (name) => {
      probe.style.color = `var(--${name})`;
      return shown.color;
    };
    const names = ["card", "ink", "muted", "line", "accent", "warm", "second", "good", "sky", "ground", "wall"];
    colors = Object.fromEntries(names.map((name) => [name, colorOf(name)]));
    colors.isDark = shownTheme() === "dark";
    probe.remove();
  }
  return colors;
}

/** Calls a function whenever the colors have changed. */
export function onThemeChange(listener) {
  changed.add(listener);
}

/** Makes a button cycle through the system's, light and dark colors. */
export function setUpTheme(button) {
  const show = (choice) => {
    if (choice === "system") delete document.documentElement.dataset.theme;
    else document.documentElement.dataset.theme = choice;
    button.dataset.choice = choice;
    button.textContent = NAMES[choice];
    colors = null;
    for (const listener of changed) listener();
  };
  button.addEventListener("click", () => {
    show(CHOICES[(CHOICES.indexOf(button.dataset.choice) + 1) % CHOICES.length]);
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => show(button.dataset.choice));
  show("system");
}

const VIRIDIS = ["440154", "482878", "3e4989", "31688e", "26828e", "1f9e89", "35b779", "6ece58", "b5de2b", "fde725"];
const BLUES = ["eef3fa", "d3e0f0", "b0c9e6", "86abd8", "5c8cc7", "3a6cb0", "275091", "193870"];
const DARK_BLUES = ["1d2633", "223650", "284a75", "31619b", "447cbd", "6899d3", "97bbe6", "d0e2f7"];

const channels = (hex) => [0, 2, 4].map((at) => parseInt(hex.slice(at, at + 2), 16));
const MAPS = {
  values: VIRIDIS.map(channels),
  visits: BLUES.map(channels),
  darkVisits: DARK_BLUES.map(channels),
};

/** The red, green and blue of a number from 0 to 1. */
export function shade(name, share) {
  const stops = MAPS[name];
  const place = Math.min(Math.max(Number.isFinite(share) ? share : 0, 0), 1) * (stops.length - 1);
  const index = Math.min(Math.floor(place), stops.length - 2);
  return stops[index].map((low, channel) => Math.round(low + (stops[index + 1][channel] - low) * (place - index)));
}

/** A color in the form that canvases use. */
export function css([red, green, blue]) {
  return `rgb(${red}, ${green}, ${blue})`;
}

/** Black or white, whichever is readable on a color. */
export function inkOn([red, green, blue]) {
  return 0.299 * red + 0.587 * green + 0.114 * blue > 140 ? "#10151d" : "#ffffff";
}

/** The gradient of a color map, for the bar of a legend. */
export function gradient(name) {
  const stops = Array.from({ length: 11 }, (_, index) => css(shade(name, index / 10)));
  return `linear-gradient(to right, ${stops.join(", ")})`;
}
