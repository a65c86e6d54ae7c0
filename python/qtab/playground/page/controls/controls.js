// The form of the settings, made from the definitions: each with its symbol, its sentence and its checks.
// Its controls are a choice, a number with its slider, a number for each component, and the initial values.

import { make, refusalPlace, refuse } from "./elements.js";
import { highest, positions, readNumber } from "../format.js";

const TITLES = {
  initial_q: "Initial values",
  min_epsilon: "Lowest ε",
  min_learning_rate: "Lowest α",
  epsilon_decay: "Decay of ε",
  epsilon_warm_up: "Episodes before ε falls",
  epsilon_schedule: "Schedule of ε",
  learning_rate_schedule: "Schedule of α",
  learning_rate_decay: "Decay of α",
  learning_rate_warm_up: "Episodes before α falls",
  n_steps: "Steps in a target",
  max_episode_steps: "Time limit",
  low: "Lower limits",
  high: "Upper limits",
  scale: "Cells per unit",
};

/** The title of a setting: a special one, or its name in words. */
export function titleOf(name) {
  if (TITLES[name]) return TITLES[name];
  const words = name.replaceAll("_", " ");
  return words[0].toUpperCase() + words.slice(1);
}

/** The parts of every control: the label with its symbol, the sentence, and the place for an error message. */
function frame(name, definition, { forId = null, labelTag = "label" } = {}) {
  const symbol = definition.symbol ? [make("span", { className: "symbol", textContent: definition.symbol }), " "] : [];
  const label = make(labelTag, { className: "name", id: `label-${name}` }, ...symbol, titleOf(name));
  if (forId) label.htmlFor = forId;
  const sentence = make("p", { id: `about-${name}`, textContent: definition.sentence });
  const refused = refusalPlace({ id: `refused-${name}` });
  const head = make("div", { className: "head" }, label);
  return { head, sentence, refused, element: make("div", { className: "setting" }, head, sentence, refused) };
}

/** A list of names to choose from. Choices that conflict with other settings are disabled, with the reason. */
export function choiceControl(store, name, definition) {
  const id = `set-${name}`;
  const parts = frame(name, definition, { forId: id });
  const select = make("select", { id });
  select.setAttribute("aria-describedby", parts.sentence.id);
  const options = definition.choices.map(({ value }) => make("option", { value }));
  select.append(...options);
  parts.head.after(select);
  select.addEventListener("change", () => store.set(name, select.value));
  const refresh = () => {
    options.forEach((option, index) => {
      const { value, title } = definition.choices[index];
      const reason = store.impossible(name, value);
      option.disabled = reason !== null;
      option.textContent = reason ? `${title} (${reason})` : title;
    });
    select.value = store.state.settings[name];
  };
  return { element: parts.element, refresh, focus: () => select.focus() };
}

/** A text field with checked numbers. */
function numberField(parts, id, read, apply) {
  const input = make("input", { type: "text", id, inputMode: "decimal", autocomplete: "off", spellcheck: false });
  input.setAttribute("aria-describedby", `${parts.refused.id} ${parts.sentence.id}`);
  input.addEventListener("change", () => {
    const { value, refused } = read(input.value);
    refuse(parts.refused, input, refused);
    if (!refused) apply(value);
  });
  const show = (value) => {
    const text = shortest(value);
    if (input.getAttribute("aria-invalid") && document.activeElement === input) return;
    if (input.value !== text) {
      input.value = text;
      refuse(parts.refused, input, null);
    }
  };
  return { input, show };
}

/** A number as text. The limits of observations are 32-bit numbers, for which seven digits are enough. */
function shortest(value) {
  const short = Number(value.toPrecision(7));
  return String(Math.fround(short) === value ? short : value);
}

/** A number: a text field for exact values, and a slider. */
export function numberControl(store, name, definition) {
  const id = `set-${name}`;
  const parts = frame(name, definition, { forId: id });
  const limits = () => ({
    low: definition.low,
    high: highest(name, definition, store.state.settings),
    integer: definition.type === "integer",
    log: definition.log,
  });
  const field = numberField(parts, id, (text) => readNumber(name, text, limits()), (value) => store.set(name, value));
  parts.head.append(field.input);
  const slider = make("input", { type: "range", min: 0, max: 1000, step: 1, id: `slide-${name}` });
  slider.setAttribute("aria-label", titleOf(name));
  slider.addEventListener("input", () => store.set(name, positions(limits()).value(Number(slider.value))));
  slider.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10 }[event.key];
    if (!step) return;
    event.preventDefault();
    store.set(name, stepped(limits(), store.state.settings[name], step));
  });
  parts.head.after(slider);
  const refresh = () => {
    const value = store.state.settings[name];
    field.show(value);
    slider.value = positions(limits()).position(value);
    slider.setAttribute("aria-valuetext", String(value));
  };
  return { element: parts.element, refresh, focus: () => slider.focus() };
}

/** The next value for keyboard steps: hundredths of the range, at least 1 for integers; tenths of a large value. */
function stepped({ low, high, integer, log }, value, steps) {
  const size = log ? 10 ** Math.floor(Math.log10(Math.max(Math.abs(value), 1e-9)) - 0.3) : (high - low) / 100;
  const unit = integer ? Math.max(Math.round(size), 1) : Number(size.toPrecision(1));
  const next = value + steps * unit;
  return integer ? Math.round(next) : Number(next.toPrecision(10));
}

/** A number for each component of the observation, or one for all. */
export function componentsControl(store, name, definition) {
  const parts = frame(name, definition, { labelTag: "span" });
  const rows = make("div", { className: "components" });
  rows.setAttribute("role", "group");
  rows.setAttribute("aria-labelledby", `label-${name}`);
  parts.head.after(rows);
  const observations = store.entry.observations ?? [];
  const fields = observations.map((observation, index) => {
    const read = (text) =>
      readNumber(`${name} of ${observation.name}`, text, {
        low: definition.low,
        high: definition.high,
        integer: definition.type === "integers",
      });
    const field = numberField(parts, `set-${name}-${index}`, read, (value) => {
      const all = spread(store.state.settings[name], observations.length);
      all[index] = value;
      const other = { low: "high", high: "low" }[name];
      const bounds = other && store.state.settings[other];
      if (bounds && (name === "low" ? all[index] >= bounds[index] : all[index] <= bounds[index])) {
        refuse(parts.refused, field.input, `low of ${observation.name} must be less than high`);
        return;
      }
      store.set(name, all);
    });
    rows.append(make("label", {}, observation.name, field.input));
    return field;
  });
  const refresh = () => {
    spread(store.state.settings[name], fields.length).forEach((value, index) => fields[index].show(value));
  };
  return { element: parts.element, refresh, focus: () => fields[0]?.input.focus() };
}

function spread(values, length) {
  const listed = Array.isArray(values) ? values : [values];
  return listed.length === length ? [...listed] : Array(length).fill(listed[0]);
}

/** The initial values: a range from which they are drawn, whose limits may be equal. */
export function initialValuesControl(store, name, definition) {
  const parts = frame(name, definition, { labelTag: "span" });
  const rows = make("div", { className: "components" });
  rows.setAttribute("role", "group");
  rows.setAttribute("aria-labelledby", `label-${name}`);
  parts.head.after(rows);
  const range = () => {
    const value = store.state.settings[name];
    return Array.isArray(value) ? value : [value, value];
  };
  const fields = ["from", "to"].map((end, index) => {
    const read = (text) => readNumber(`${name} (${end})`, text, { low: definition.low, high: definition.high, integer: false });
    const field = numberField(parts, `set-${name}-${index}`, read, (value) => {
      const next = [...range()];
      next[index] = value;
      // A range whose limits have crossed becomes a single number.
      if (next[0] > next[1]) next[1 - index] = value;
      store.set(name, next[0] === next[1] ? next[0] : next);
    });
    rows.append(make("label", {}, end, field.input));
    return field;
  });
  const refresh = () => range().forEach((value, index) => fields[index].show(value));
  return { element: parts.element, refresh, focus: () => fields[0].input.focus() };
}

/** Settings that are not needed at first. */
const LESS_NEEDED = new Set([
  ...["learning_rate_schedule", "min_learning_rate", "learning_rate_decay", "learning_rate_warm_up", "traces", "trace_cutoff"],
  ...["initial_q", "terminal_update", "on_truncation", "epsilon_warm_up", "ties", "max_episode_steps", "bit_generator"],
  ...["low", "high"],
]);
const GROUP_ORDER = ["Learning", "Exploration", "Discretizer", "Run"];

/** Builds the controls of a store's settings and keeps them up to date. */
export class Controls {
  constructor(form, store, extras) {
    this.form = form;
    this.store = store;
    this.extras = extras;
    this.controls = new Map();
    this.shape = "";
    form.addEventListener("submit", (event) => event.preventDefault());
    store.subscribe(() => this.refresh());
    this.refresh();
  }

  /** Shows the settings of the state; rebuilds the form only if other settings apply. */
  refresh() {
    const { state } = this.store;
    const shape = [state.environment, ...Object.keys(state.settings)].join(" ");
    if (shape !== this.shape) this.build();
    this.shape = shape;
    for (const control of this.controls.values()) control.refresh();
  }

  build() {
    const focused = document.activeElement?.closest?.("[data-setting]")?.dataset.setting;
    const open = this.form.querySelector("details.more")?.open ?? false;
    this.controls.clear();
    const { settings: known } = this.store.definitions;
    const names = Object.keys(known).filter((name) => name in this.store.state.settings);
    const main = names.filter((name) => !LESS_NEEDED.has(name));
    const more = names.filter((name) => LESS_NEEDED.has(name));
    const groups = this.groups(main);
    groups.find(({ title }) => title === "Run")?.fieldset.append(this.extras);
    const details = document.createElement("details");
    details.className = "more";
    details.open = open;
    const summary = document.createElement("summary");
    summary.textContent = "More settings";
    details.append(summary, ...this.groups(more).map(({ fieldset }) => fieldset));
    this.form.replaceChildren(...groups.map(({ fieldset }) => fieldset), details);
    if (focused) this.controls.get(focused)?.focus();
  }

  groups(names) {
    const { settings: known } = this.store.definitions;
    const titles = [...new Set(names.map((name) => known[name].group))];
    titles.sort((left, right) => GROUP_ORDER.indexOf(left) - GROUP_ORDER.indexOf(right));
    return titles.map((title) => {
      const fieldset = document.createElement("fieldset");
      const legend = document.createElement("legend");
      legend.textContent = title;
      fieldset.append(legend, ...names.filter((name) => known[name].group === title).map((name) => this.control(name)));
      return { title, fieldset };
    });
  }

  control(name) {
    const definition = this.store.definitions.settings[name];
    const make = { choice: choiceControl, number: numberControl, integer: numberControl, initial_q: initialValuesControl };
    const control = (make[definition.type] ?? componentsControl)(this.store, name, definition);
    control.element.dataset.setting = name;
    this.controls.set(name, control);
    return control.element;
  }
}
