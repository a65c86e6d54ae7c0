// Single-key shortcuts, which can be turned off, and the dialog that lists them.

import { make } from "./elements.js";

/** Lists `shortcuts`, [key, description, function], in a table and listens for them. */
export function setUpShortcuts(shortcuts, { table, isOn, isBlocked }) {
  const rows = [
    ...shortcuts.map(([key, text]) => [[key], text]),
    [["←", "→", "↑", "↓"], "on a map: move between states; on sliders and choices: change them"],
    [["Enter"], "on the first map: select the state, or paint it"],
  ];
  for (const [keys, text] of rows) {
    const shown = keys.flatMap((key) => [make("kbd", { textContent: key }), " "]);
    table.append(make("tr", {}, make("td", {}, ...shown), make("td", { textContent: text })));
  }
  document.addEventListener("keydown", (event) => {
    if (!isOn() || event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented || isBlocked()) return;
    if (event.target.closest?.("input:not([type=range]):not([type=checkbox]), select, textarea, pre, [contenteditable]")) return;
    const found = shortcuts.find(([key]) => key.toLowerCase() === event.key.toLowerCase());
    if (!found) return;
    event.preventDefault();
    found[2]();
  });
}

/** Opens a dialog with a button, and closes it with its close buttons or by a press beside it. */
export function setUpDialog(dialog, opener, onOpen = () => {}) {
  const open = () => {
    onOpen();
    dialog.showModal();
  };
  opener.addEventListener("click", open);
  for (const button of dialog.querySelectorAll("[data-close]")) button.addEventListener("click", () => dialog.close());
  dialog.addEventListener("click", (event) => {
    if (event.target === dialog) dialog.close();
  });
  return open;
}
