// The seed, and whether to train one agent or sixteen.

import { make, refusalPlace, refuse } from "./elements.js";
import { moveWithArrows } from "./environments.js";
import { readNumber } from "../format.js";
import { MANY_SEEDS } from "../store.js";

const LARGEST = 2 ** 32 - 1 - MANY_SEEDS;

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
  const refused = refusalPlace();
  input.addEventListener("change", () => {
    const { value, refused: message } = readNumber("seed", input.value, { low: 0, high: LARGEST, integer: true });
    refuse(refused, input, message);
    if (!message) store.update({ seed: value });
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
      refuse(refused, input, null);
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
