// Light and dark colors: the reader's system decides unless the button overrides it.

const CHOICES = ["system", "light", "dark"];
const NAMES = { system: "System colors", light: "Light colors", dark: "Dark colors" };
const changed = new Set();
let colors = null;

/** The current theme: "light" or "dark". */
export function shownTheme() {
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
    const names = ["paper", "card", "ink", "muted", "line", "accent", "warm", "good", "sky", "ground", "wall"];
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
