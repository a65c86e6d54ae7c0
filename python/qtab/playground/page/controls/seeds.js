// The seed, and whether to train one agent or sixteen.

import { make, radioButtons, refusalPlace, refuse } from "./elements.js";
import { readNumber } from "../format.js";
import { MANY_SEEDS, SEED_LIMITS } from "../store.js";

/** The controls of the seeds, for the group "Run". */
export function seedControls(store) {
  const group = make("div", { className: "segments", role: "radiogroup", "aria-labelledby": "label-seeds" });
  const mark = radioButtons(group, "seeds", [[1, "1 seed"], [MANY_SEEDS, `${MANY_SEEDS} seeds`]], (seeds) => store.update({ seeds }));
  const refused = refusalPlace();
  const onchange = () => {
    const { value, refused: message } = readNumber("seed", input.value, SEED_LIMITS);
    refuse(refused, input, message);
    if (!message) store.update({ seed: value });
  };
  const input = make("input", { type: "text", inputMode: "numeric", id: "set-seed", autocomplete: "off", onchange });
  const onclick = () => store.update({ seed: (store.state.seed + 1) % SEED_LIMITS.high });
  const another = make("button", { type: "button", className: "small", textContent: "Next seed", onclick });
  const show = ({ seed, seeds }) => {
    mark(seeds);
    if (document.activeElement !== input || !input.hasAttribute("aria-invalid")) {
      input.value = String(seed);
      refuse(refused, input, null);
    }
  };
  store.subscribe(show);
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
