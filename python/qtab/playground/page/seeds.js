// The seed, and whether to train one agent or sixteen.

import { moveWithArrows } from "./environments.js";
import { readNumber } from "./numbers.js";
import { MANY_SEEDS } from "./store.js";

const LARGEST = 2 ** 32 - 1 - MANY_SEEDS;

function make(tag, properties = {}, ...children) {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
}

/** The controls of the seeds, for the group "Run". */
export function seedControls(store) {
  const buttons = [[1, "1 seed"], [MANY_SEEDS, `${MANY_SEEDS} seeds`]].map(([seeds, textContent]) => {
    const button = make("button", { type: "button", textContent });
    button.setAttribute("role", "radio");
    button.dataset.seeds = seeds;
    button.addEventListener("click", () => store.update({ seeds }));
    return button;
  });
  const group = make("div", { className: "segments" }, ...buttons);
  group.setAttribute("role", "radiogroup");
  group.setAttribute("aria-labelledby", "label-seeds");
  moveWithArrows(group, (button) => button.click());
  const input = make("input", { type: "text", inputMode: "numeric", id: "set-seed", autocomplete: "off" });
  const refused = make("p", { className: "refused", hidden: true });
  refused.setAttribute("role", "alert");
  input.addEventListener("change", () => {
    const { value, refused: message } = readNumber("seed", input.value, { low: 0, high: LARGEST, integer: true });
    refused.hidden = !message;
    refused.textContent = message ? `${message}. The value before is kept.` : "";
    if (message) input.setAttribute("aria-invalid", "true");
    else {
      input.removeAttribute("aria-invalid");
      store.update({ seed: value });
    }
  });
  const another = make("button", { type: "button", className: "small", textContent: "Next seed" });
  another.addEventListener("click", () => store.update({ seed: (store.state.seed + 1) % LARGEST }));
  const show = ({ seed, seeds }) => {
    for (const button of buttons) {
      const chosen = Number(button.dataset.seeds) === seeds;
      button.setAttribute("aria-checked", chosen);
      button.tabIndex = chosen ? 0 : -1;
    }
    if (document.activeElement !== input || !input.hasAttribute("aria-invalid")) {
      input.value = String(seed);
      input.removeAttribute("aria-invalid");
      refused.hidden = true;
    }
  };
  store.subscribe((state) => show(state));
  show(store.state);
  const seedLabel = make("label", { htmlFor: input.id, className: "name", textContent: "Seed" });
  const manyLabel = make("span", { className: "name", id: "label-seeds", textContent: "Agents" });
  return make(
    "div",
    {},
    make("div", { className: "setting" }, make("div", { className: "head" }, seedLabel, another, input),
      make("p", { textContent: "The seed of the environment and of the agent: the same seed gives the same run." }), refused),
    make("div", { className: "setting" }, make("div", { className: "head" }, manyLabel), group,
      make("p", { textContent: `One agent, or ${MANY_SEEDS} with consecutive seeds: a single seed can be lucky.` })),
  );
}
