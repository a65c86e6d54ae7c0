// The form of the settings, made from the definitions: each with its symbol, its sentence and its checks.

import { choiceControl, componentsControl, initialValuesControl, numberControl } from "./control_types.js";

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
