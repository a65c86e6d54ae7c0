// The panel of Baird's counterexample: a method, its step sizes, and how many sweeps to show.

import { drawStates, drawWeights, LINES } from "./pictures.js";
import { expectedUpdates, valueError, valuesOf } from "./updates.js";
import { make, radioButtons } from "../controls/elements.js";
import { onResize } from "../drawing/surface.js";
import { onThemeChange } from "../drawing/theme.js";
import { count, counted, number, positions } from "../format.js";

const SWEEPS = 1000;
/** The methods, with the step sizes of the book's Figures 11.2, 11.5 and 11.6. */
const SHOWN = {
  td: {
    title: "Semi-gradient TD",
    alpha: 0.01,
    text: "Semi-gradient TD(0), in expectation: w ← w + α E[ρ δ x]. The target of all states is the value of the lower one, which rises with every update of the others: the weights grow without bound, whatever the step size. A smaller α only delays it.",
  },
  tdc: {
    title: "TDC",
    alpha: 0.005,
    beta: 0.05,
    text: "TD with gradient correction, in expectation, with a second weight vector v and its step size β. It follows the gradient of the projected Bellman error, so the weights stay bounded if v learns fast enough: with a β far below α they grow, too. The values approach 0 slowly: √VE is still about 2 after 1,000 sweeps.",
  },
  emphatic_td: {
    title: "Emphatic TD",
    alpha: 0.03,
    text: "One-step emphatic TD, in expectation: an update counts as often as the target policy, started anywhere, would visit its state, which is mostly the lower one. After oscillations √VE falls to 0. Sampled updates vary so much that one rarely sees this.",
  },
};
/** Step sizes with which no weight overflows in these sweeps. */
const ALPHAS = { low: 1e-4, high: 0.2, integer: false, log: true };
const STORY =
  "Seven states, and a reward of 0 everywhere. The value of a state is a sum of its own weight and of w₈, which all states share; with weights of 0 all values are right. From every state, the solid action leads to the lower state and the dashed one to one of the six upper ones. The behavior takes the dashed action six times in seven, so that it is in each state equally often; the target policy always takes the solid one (γ = 0.99).";
const SOURCE =
  "Sutton & Barto, 2nd edition, sections 11.2, 11.7 and 11.8. In Python: qtab book 11.2, 11.5 and 11.6, and qtab.prediction.expected_updates.";

/** A slider below its label and its number. */
function slider(id, text, properties) {
  const value = make("span", { className: "value" });
  const input = make("input", { type: "range", id, min: 0, step: 1, ...properties });
  const head = make("div", { className: "head" }, make("label", { htmlFor: id, textContent: text }), value);
  const show = (position, words) => {
    input.value = position;
    value.textContent = words;
    input.setAttribute("aria-valuetext", words);
  };
  return { element: make("div", { className: "watched" }, head, input), input, show };
}

/**
 * Builds the panel when the reader or an address first opens it; another address can close it. The state of the store has
 * the method of the open panel as its `counterexample`. `onChoice()` is called after each change of it, which starts no
 * training.
 */
export function setUpCounterexample(store, details, onChoice) {
  let panel = null;
  const note = (method) => {
    if ((store.state.counterexample ?? null) === method) return;
    store.state = { ...store.state, counterexample: method };
    onChoice();
  };
  details.addEventListener("toggle", () => {
    if (details.open) panel ??= build(details.querySelector("div"), store.state.counterexample ?? "td", note);
    note(details.open ? panel.method : null);
  });
  const follow = ({ counterexample }) => {
    details.open = Boolean(counterexample);
    if (counterexample && panel && panel.method !== counterexample) panel.choose(counterexample);
  };
  store.subscribe(follow);
  follow(store.state);
}

/** Fills the panel; returns its method, and a function that chooses another one. `note(method)` receives each choice. */
function build(place, method, note) {
  const state = { method, alpha: SHOWN[method].alpha, beta: SHOWN.tdc.beta, sweeps: SWEEPS };
  const change = (changes) => {
    Object.assign(state, changes);
    show();
  };
  const choose = (chosen) => {
    change({ method: chosen, alpha: SHOWN[chosen].alpha });
    note(chosen);
  };
  const group = make("div", { className: "segments", role: "radiogroup", "aria-label": "Method" });
  const choices = Object.entries(SHOWN).map(([method, { title }]) => [method, title]);
  const mark = radioButtons(group, "method", choices, choose);
  const { value, position } = positions(ALPHAS);
  const ofRate = (name) => ({ max: 1000, oninput: (event) => change({ [name]: value(Number(event.target.value)) }) });
  const alpha = slider("counterexample-alpha", "Step size α", ofRate("alpha"));
  const beta = slider("counterexample-beta", "Step size β of v", ofRate("beta"));
  const onsweep = { max: SWEEPS, oninput: (event) => change({ sweeps: Number(event.target.value) }) };
  const sweeps = slider("counterexample-sweeps", "Sweeps over the states", onsweep);
  const text = make("p", { className: "hint" });
  const states = make("canvas", { className: "chart", role: "img" });
  const chart = make("canvas", { className: "chart", role: "img" });
  const key = LINES.map(([name, color]) => {
    const item = make("li", { textContent: name });
    item.style.setProperty("--color", `var(--${color})`);
    return item;
  });
  const summary = make("figcaption", { "aria-live": "polite" });
  const controls = make("div", { className: "rates" }, alpha.element, beta.element, sweeps.element);
  const left = make("figure", {}, states, make("figcaption", { textContent: "The states, with their values after these sweeps; the true values are 0. The arrows are the solid action, and the dashed one leads to any state inside the dashed line." }));
  const right = make("figure", {}, chart, make("ul", { className: "key" }, ...key), summary);
  const story = [STORY, SOURCE].map((textContent) => make("p", { className: "hint", textContent }));
  place.replaceChildren(story[0], group, text, controls, make("div", { className: "two" }, left, right), story[1]);

  let weights = [];
  const draw = () => {
    drawStates(states, weights[state.sweeps]);
    drawWeights(chart, weights, state.sweeps);
  };
  const show = () => {
    const { title, text: about } = SHOWN[state.method];
    mark(state.method);
    weights = expectedUpdates(state.method, SWEEPS, state.alpha, state.beta);
    alpha.show(position(state.alpha), number(state.alpha));
    beta.show(position(state.beta), number(state.beta));
    beta.element.hidden = state.method !== "tdc";
    sweeps.show(state.sweeps, count(state.sweeps));
    text.textContent = about;
    const w = weights[state.sweeps];
    summary.textContent = `After ${counted(state.sweeps, "sweep")}: w₁ to w₆ = ${number(w[0])}, w₇ = ${number(w[6])}, w₈ = ${number(w[7])}, √VE = ${number(valueError(w))}.`;
    chart.setAttribute("aria-label", `The weights of ${title} over the sweeps. ${summary.textContent}`);
    const values = valuesOf(w);
    states.setAttribute("aria-label", `Seven states. The values of the upper six: ${number(values[0])}; of the lower one: ${number(values[6])}.`);
    draw();
  };
  show();
  onResize([states, chart], draw);
  onThemeChange(draw);
  return { choose, get method() { return state.method; } };
}
