// The form of the settings, made from the definitions: each with its symbol, its sentence and its checks.
// Its controls are a choice, a number with its slider, a number for each component, and the initial values.

import { make, refusalPlace, refuse } from "./elements.js";
import { fallingText } from "./schedules.js";
import { highest, positions, readNumber, sliderRange } from "../format.js";

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
  scale_step_sizes: "Scaled step sizes",
};

/** The title of a setting: a special one, or its name in words. */
function titleOf(name) {
  if (TITLES[name]) return TITLES[name];
  const words = name.replaceAll("_", " ");
  return words[0].toUpperCase() + words.slice(1);
}

/**
 * The parts of every control: the label with its symbol, the sentence, and the place for an error message. `id` is that
 * of the element that the label names; null for several.
 */
function frame(name, definition, id = null) {
  const symbol = definition.symbol ? [make("span", { className: "symbol", textContent: definition.symbol }), " "] : [];
  const [tag, target] = id ? ["label", { htmlFor: id }] : ["span", {}];
  const label = make(tag, { className: "name", id: `label-${name}`, ...target }, ...symbol, titleOf(name));
  const head = make("div", { className: "head" }, label);
  const sentence = make("p", { id: `about-${name}`, textContent: definition.sentence });
  const refused = refusalPlace({ id: `refused-${name}` });
  return { head, sentence, refused, element: make("div", { className: "setting" }, head, sentence, refused) };
}

/** A list of names to choose from. Choices that conflict with other settings are disabled, with the reason. */
function choiceControl(store, name, definition) {
  const id = `set-${name}`;
  const parts = frame(name, definition, id);
  const options = definition.choices.map(({ value }) => make("option", { value }));
  const onchange = () => store.set(name, select.value);
  const select = make("select", { id, "aria-describedby": parts.sentence.id, onchange }, ...options);
  parts.head.after(select);
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

/** A box to check. */
function flagControl(store, name, definition) {
  const id = `set-${name}`;
  const parts = frame(name, definition, id);
  const onchange = () => store.set(name, box.checked);
  const box = make("input", { type: "checkbox", id, "aria-describedby": parts.sentence.id, onchange });
  parts.head.append(box);
  const refresh = () => { box.checked = store.state.settings[name]; };
  return { element: parts.element, refresh, focus: () => box.focus() };
}

/** A text field with checked numbers. `apply(value)` may return a reason to reject one. */
function numberField({ refused: place, sentence }, id, read, apply) {
  const onchange = () => {
    const { value, refused } = read(input.value);
    refuse(place, input, refused);
    const problem = refused ? null : apply(value);
    if (problem) refuse(place, input, problem);
  };
  const described = { "aria-describedby": `${place.id} ${sentence.id}` };
  const input = make("input", { type: "text", id, inputMode: "decimal", autocomplete: "off", spellcheck: false, ...described, onchange });
  const show = (value) => {
    const text = shortest(value);
    if (input.getAttribute("aria-invalid") && document.activeElement === input) return;
    if (input.value !== text) {
      input.value = text;
      refuse(place, input, null);
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
function numberControl(store, name, definition) {
  const id = `set-${name}`;
  const parts = frame(name, definition, id);
  const limits = () => ({
    low: definition.low,
    high: highest(name, definition, store.state.settings, store.definitions),
    integer: definition.type === "integer",
    log: definition.log,
  });
  const range = () => sliderRange(name, limits(), store.state.settings);
  const field = numberField(parts, id, (text) => readNumber(name, text, limits()), (value) => store.set(name, value));
  const falling = make("span", { className: "falling", id: `falling-${name}` });
  parts.head.append(field.input, falling);
  field.input.setAttribute("aria-describedby", `${falling.id} ${field.input.getAttribute("aria-describedby")}`);
  const oninput = () => store.set(name, positions(range()).value(Number(slider.value)));
  const onkeydown = (event) => {
    const step = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10 }[event.key];
    if (!step) return;
    event.preventDefault();
    store.set(name, stepped(range(), store.state.settings[name], step));
  };
  const places = { type: "range", min: 0, max: 1000, step: 1, id: `slide-${name}`, "aria-label": titleOf(name) };
  const slider = make("input", { ...places, oninput, onkeydown });
  parts.head.after(slider);
  const refresh = () => {
    const value = store.state.settings[name];
    field.show(value);
    slider.value = positions(range()).position(value);
    falling.textContent = fallingText(store.state.settings, name);
    falling.hidden = falling.textContent === "";
    slider.setAttribute("aria-valuetext", `${value} ${falling.textContent}`.trim());
  };
  return { element: parts.element, refresh, focus: () => slider.focus() };
}

/** The next value for keyboard steps: hundredths of the range, at least 1 for integers; tenths of a large value. */
function stepped({ low, high, integer, log }, value, steps) {
  const size = log ? 10 ** Math.floor(Math.log10(Math.max(Math.abs(value), low, 1e-9)) - 0.3) : (high - low) / 100;
  const unit = integer ? Math.max(Math.round(size), 1) : Number(size.toPrecision(1));
  const next = value + steps * unit;
  return integer ? Math.round(next) : Number(next.toPrecision(10));
}

/**
 * A row of numbers. `labels`: [label, name in messages] of each; `values()`: the numbers of the state; `change(values,
 * index)` sets them after one was typed, or returns a reason to reject it.
 */
function rowControl(name, definition, labels, values, change) {
  const parts = frame(name, definition);
  const limits = { low: definition.low, high: definition.high, integer: definition.type === "integers" };
  const fields = labels.map(([, named], index) => {
    const apply = (value) => change(values().map((each, place) => (place === index ? value : each)), index);
    return numberField(parts, `set-${name}-${index}`, (text) => readNumber(named, text, limits), apply);
  });
  const labelled = fields.map(({ input }, index) => make("label", {}, labels[index][0], input));
  parts.head.after(make("div", { className: "components", role: "group", "aria-labelledby": `label-${name}` }, ...labelled));
  const refresh = () => values().forEach((value, index) => fields[index].show(value));
  return { element: parts.element, refresh, focus: () => fields[0].input.focus() };
}

/** A number for each component of the observation, or one for all. */
function componentsControl(store, name, definition) {
  const { observations } = store.entry;
  const values = () => {
    const listed = [store.state.settings[name]].flat();
    return listed.length === observations.length ? listed : observations.map(() => listed[0]);
  };
  const change = (all, index) => {
    const { low, high } = { ...store.state.settings, [name]: all };
    const crossed = ["low", "high"].includes(name) && low && high && low[index] >= high[index];
    if (crossed) return `low of ${observations[index].name} must be less than high`;
    return store.set(name, all);
  };
  return rowControl(name, definition, observations.map((each) => [each.name, `${name} of ${each.name}`]), values, change);
}

/** The initial values: a range from which they are drawn, whose limits may be equal. */
function initialValuesControl(store, name, definition) {
  const values = () => {
    const value = store.state.settings[name];
    return Array.isArray(value) ? value : [value, value];
  };
  const change = ([from, to], index) => {
    // A range whose limits have crossed becomes a single number.
    if (from >= to) store.set(name, index ? to : from);
    else store.set(name, [from, to]);
  };
  return rowControl(name, definition, ["from", "to"].map((end) => [end, `${name} (${end})`]), values, change);
}

/** Settings that are not needed at first. */
const LESS_NEEDED = new Set([
  ...["learning_rate_schedule", "min_learning_rate", "learning_rate_decay", "learning_rate_warm_up", "traces", "trace_cutoff"],
  ...["initial_q", "terminal_update", "on_truncation", "epsilon_warm_up", "ties", "max_episode_steps", "bit_generator"],
  ...["low", "high", "scale_step_sizes"],
]);
const CONTROLS = { choice: choiceControl, flag: flagControl, number: numberControl, integer: numberControl, initial_q: initialValuesControl };
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
    const names = Object.keys(this.store.definitions.settings).filter((name) => name in this.store.state.settings);
    const main = this.groups(names.filter((name) => !LESS_NEEDED.has(name)));
    main.get("Run")?.append(this.extras);
    const more = this.groups(names.filter((name) => LESS_NEEDED.has(name)));
    const summary = make("summary", { textContent: "More settings" });
    this.form.replaceChildren(...main.values(), make("details", { className: "more", open }, summary, ...more.values()));
    if (focused) this.controls.get(focused)?.focus();
  }

  /** The fieldset of each group of settings, by its title. */
  groups(names) {
    const { settings: known } = this.store.definitions;
    const titles = [...new Set(names.map((name) => known[name].group))];
    titles.sort((left, right) => GROUP_ORDER.indexOf(left) - GROUP_ORDER.indexOf(right));
    return new Map(titles.map((title) => {
      const controls = names.filter((name) => known[name].group === title).map((name) => this.control(name));
      return [title, make("fieldset", {}, make("legend", { textContent: title }), ...controls)];
    }));
  }

  control(name) {
    const definition = this.store.definitions.settings[name];
    const control = (CONTROLS[definition.type] ?? componentsControl)(this.store, name, definition);
    control.element.dataset.setting = name;
    this.controls.set(name, control);
    return control.element;
  }
}
