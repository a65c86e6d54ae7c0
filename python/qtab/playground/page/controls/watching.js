// Watching an agent learn: the speed of training, the agent as it was after some episodes, and another one beside it.

import { make } from "./elements.js";
import { count } from "../format.js";

/** The steps of each agent in a second, by the place of the slider. */
const PACES = [1, 2, 5, 10, 30, 100, 300, 1000, 5000, Infinity];
const MOST_PLACES = 60;

/** A control below its label and what is beside the label. */
function labelled(label, control, ...more) {
  return make("div", { className: "watched" }, make("div", { className: "head" }, label, ...more), control);
}

/** The slider of the speed. `choose(steps)` receives the steps in a second, Infinity for all at once. */
export function paceControl(choose) {
  const output = make("span", { className: "value" });
  const slider = make("input", { type: "range", id: "pace", min: 0, max: PACES.length - 1, step: 1, value: PACES.length - 1 });
  const show = () => {
    const steps = PACES[slider.value];
    output.textContent = steps === Infinity ? "all at once" : steps === 1 ? "1 step a second" : `${count(steps)} steps a second`;
    slider.setAttribute("aria-valuetext", output.textContent);
  };
  slider.addEventListener("input", () => {
    show();
    choose(PACES[slider.value]);
  });
  show();
  return labelled(make("label", { htmlFor: "pace", textContent: "Speed" }), slider, output);
}

/** The numbers of episodes to look back at, in a run of which some are finished. */
export function placesOf(done) {
  const places = Math.min(done, MOST_PLACES);
  return places ? Array.from({ length: places + 1 }, (_, place) => Math.round((place / places) * done)) : [0];
}

/** The slider over the training. `look(episodes, places)` receives the number of episodes, null for the newest values. */
export class PastControl {
  constructor(look) {
    this.look = look;
    this.places = [0];
    this.output = make("span", { className: "value" });
    const oninput = () => this.moved();
    this.slider = make("input", { type: "range", id: "past", min: 0, max: 0, step: 1, value: 0, oninput });
    this.element = labelled(make("label", { htmlFor: "past", textContent: "Look back" }), this.slider, this.output);
    this.show(0, true);
  }

  /** Shows how many episodes are finished. The newest values are shown then. */
  show(done, isTraining) {
    this.places = placesOf(done);
    this.slider.max = this.places.length - 1;
    this.slider.value = this.slider.max;
    this.slider.disabled = isTraining || done === 0;
    this.describe();
  }

  get isAtEnd() {
    return Number(this.slider.value) === this.places.length - 1;
  }

  moved() {
    this.describe();
    this.look(this.isAtEnd ? null : this.places[this.slider.value], this.places);
  }

  describe() {
    const episodes = this.places[this.slider.value];
    this.output.textContent = `episode ${count(episodes)} of ${count(this.places.at(-1))}`;
    this.slider.setAttribute("aria-valuetext", this.output.textContent);
  }
}

/** The algorithm of an agent to compare with, or none. */
export function comparisonControl(store) {
  const { choices } = store.definitions.settings.algorithm;
  const none = make("option", { value: "", textContent: "no other agent" });
  const options = choices.map(({ value }) => make("option", { value }));
  const onchange = () => store.update({ compared: select.value || null });
  const select = make("select", { id: "compared", onchange }, none, ...options);
  const show = ({ settings }) => {
    options.forEach((option, index) => {
      const { value, title } = choices[index];
      const reason = value === settings.algorithm ? "this agent" : store.impossible("algorithm", value);
      option.disabled = reason !== null;
      option.textContent = reason ? `${title} (${reason})` : title;
    });
    select.value = store.otherSettings ? store.state.compared : "";
  };
  store.subscribe(show);
  show(store.state);
  return labelled(make("label", { htmlFor: "compared", textContent: "Compare with" }), select);
}
