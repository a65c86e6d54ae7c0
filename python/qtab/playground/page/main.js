// Connects the parts of the page: the reader's choices, the engine that trains, and the view of its results.

import { Controls } from "./controls/controls.js";
import { setUpEnvironments } from "./controls/environments.js";
import { EXAMPLES, exampleState, setUpExamples } from "./controls/examples.js";
import { seedControls } from "./controls/seeds.js";
import { setUpDialog, setUpShortcuts } from "./controls/shortcuts.js";
import { comparisonControl, paceControl, PastControl } from "./controls/watching.js";
import { setUpCounterexample } from "./counterexample/panel.js";
import { expectedUpdates } from "./counterexample/updates.js";
import { setUpTheme } from "./drawing/theme.js";
import { definitions, Engine } from "./engine.js";
import { copyText, pythonProgram } from "./python_code.js";
import { View } from "./results/view.js";
import { fragment, hasSettings, restore, settingsText } from "./share.js";
import { fit, Store } from "./store.js";
import { Training } from "./training.js";

const ADDRESS_DELAY = 400;
const SPOKEN_DELAY = 700;
const element = (id) => document.getElementById(id);

function start() {
  let spoken = 0;
  const announce = (text, delay = 0) => {
    clearTimeout(spoken);
    const say = () => { element("live").textContent = typeof text === "function" ? text() : text; };
    if (delay) spoken = setTimeout(say, delay);
    else say();
  };
  setUpTheme(element("theme"));
  const store = new Store(definitions);
  store.state = exampleState(store, store.state.environment, 0);
  const left = restore(store, `${location.search.slice(1)}&${location.hash.slice(1)}`);
  const view = new View(store, announce, (cell) => training.inspect(cell));
  const past = new PastControl((episodes, places) => {
    for (const each of agents()) each.engine.lookBack(episodes, places);
    if (episodes === null) view.showPast(null);
  });
  // An answer may come after the slider has returned to the newest values.
  const isLate = (message) => message.type === "past" && past.isAtEnd;
  const training = new Training(store, Engine, {
    onStart: () => view.expectAnother(),
    onResult: (message) => {
      if (isLate(message)) return;
      if (message.type === "result") past.show(message.done, message.state === "training");
      view.show(message);
      if (["paused", "finished", "diverged"].includes(message.state)) announce(() => view.spoken(message), SPOKEN_DELAY);
    },
    onProblem: (message) => view.showProblem(message),
  });
  let other = null; // the training of the agent to compare with
  const newOther = () => new Training(store, Engine, {
    onStart: () => {},
    onResult: (message) => isLate(message) || view.showOther(message),
    onProblem: (message) => view.showOtherProblem(message),
    request: () => ({ ...store.request(store.otherSettings), best: false }),
    inspects: false,
  });
  const agents = () => (store.otherSettings ? [training, (other ??= newOther())] : [training]);
  let steps = Infinity;
  const setPace = (chosen) => {
    steps = chosen;
    for (const each of agents()) each.setPace(steps);
  };
  element("watching").append(paceControl(setPace), past.element, comparisonControl(store));
  setUpEnvironments(store, element("environments"), element("environment-title"), element("environment-sentence"));
  setUpExamples(store, element("examples"), element("look"));
  new Controls(element("settings"), store, seedControls(store));
  const note = (names) => {
    if (names.length) view.showNote(`Some parts of the address are not valid and were left out or changed: ${names.slice(0, 8).join(", ")}.`);
  };
  const noteAddress = setUpPage(store, agents, view, note, announce);
  setUpCounterexample(store, element("counterexample"), noteAddress);
  const start = () => {
    if (!store.otherSettings) other?.stop();
    for (const each of agents()) {
      each.engine.setPace(steps);
      each.start();
    }
  };
  store.subscribe(start);
  start();
  note(left);
  addEventListener("hashchange", () => note(restore(store, location.hash.slice(1))));
  if (matchMedia("(max-width: 860px)").matches) element("settings-fold").open = false;
  globalThis.playground = { engine: training.engine, store, training, agents, view, fragment, restore, fit, pythonProgram, EXAMPLES, exampleState, expectedUpdates };
}

/** Connects the buttons, the dialogs and the address; returns a function that writes the address soon. */
function setUpPage(store, agents, view, note, announce) {
  /** The agents to train on: those that are not at their end, or all if each of them is. */
  const next = () => {
    const unfinished = agents().filter((each) => ["training", "paused"].includes(each.state));
    return unfinished.length ? unfinished : agents();
  };
  const press = {
    run: () => next().forEach((each) => each.run()),
    stop: () => agents().forEach((each) => each.stop()),
    step: () => next().forEach((each) => each.advance("step")),
    "one-episode": () => next().forEach((each) => each.advance("episode")),
    reset: () => agents().forEach((each) => each.reset()),
  };
  for (const [id, action] of Object.entries(press)) element(id).addEventListener("click", action);
  const program = () => { element("python-code").textContent = pythonProgram(store, view.shownMeasure); };
  // Following the link would replace the fragment, which stores the settings.
  document.querySelector(".skip").addEventListener("click", (event) => {
    event.preventDefault();
    element("results").focus();
  });
  const openPython = setUpDialog(element("python-dialog"), element("python-open"), program);
  const openShortcuts = setUpDialog(element("shortcuts-dialog"), element("shortcuts-open"));
  const copied = async (text, button, what) => {
    const done = await copyText(text);
    const label = button.dataset.label ?? button.textContent;
    button.dataset.label = label;
    button.textContent = done ? "Copied" : "Copying not allowed";
    setTimeout(() => { button.textContent = label; }, 1600);
    announce(done ? `${what} copied.` : "The browser does not allow copying.");
  };
  element("python-copy").addEventListener("click", () => copied(pythonProgram(store, view.shownMeasure), element("python-copy"), "Program"));
  // The address of a file means nothing on another computer: only the settings can be shared then.
  const isFile = location.protocol === "file:";
  const shared = () => `${isFile ? "" : location.href.split(/[?#]/)[0]}#${fragment(store)}`;
  element("share-text").textContent = isFile
    ? "This page is a file on your computer. Send the text below: it opens in another copy of the page, with Share or at the end of its address."
    : "This link opens the page with the task, the settings and the seeds that you see.";
  const openShare = setUpDialog(element("share-dialog"), element("share-open"), () => {
    element("share-link").value = shared();
    element("share-given").value = "";
  });
  element("share-copy").addEventListener("click", () => copied(shared(), element("share-copy"), isFile ? "Settings" : "Link"));
  const open = () => {
    const text = settingsText(element("share-given").value);
    if (!text) return;
    if (hasSettings(store, text)) note(restore(store, text));
    else view.showNote("Nothing was changed: the text has no settings of this page, or is too long.");
    element("share-dialog").close();
  };
  element("share-restore").addEventListener("click", open);
  element("share-given").addEventListener("keydown", (event) => {
    if (event.key === "Enter") open();
  });
  let waiting = 0;
  const noteAddress = () => {
    clearTimeout(waiting);
    waiting = setTimeout(() => history.replaceState(null, "", `#${fragment(store)}`), ADDRESS_DELAY);
  };
  store.subscribe(noteAddress);
  setUpShortcuts(
    [
      ["r", "run to the end", press.run],
      ["x", "stop", press.stop],
      ["s", "one step", press.step],
      ["e", "one episode", press["one-episode"]],
      ["0", "reset to the untrained agent", press.reset],
      ["m", "play or pause the motion", () => view.motion.setPlaying(!view.motion.playing)],
      ["v", "go to the map of values", () => view.values.cell.focus()],
      ["c", "copy as Python", openPython],
      ["l", "share these settings, or open shared ones", openShare],
      ["?", "these shortcuts", openShortcuts],
    ],
    {
      table: element("shortcuts-table"),
      isOn: () => element("shortcuts-on").checked,
      isBlocked: () => document.querySelector("dialog[open]") !== null,
    },
  );
  return noteAddress;
}

start();
