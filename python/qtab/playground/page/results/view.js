// The view of a result: status, learning curve, motion, maps and the selected state.

import { radioButtons } from "../controls/elements.js";
import { Painter } from "../controls/painter.js";
import { bestReturn, LearningCurve, Marks } from "../drawing/curve.js";
import { stateWords } from "../drawing/games.js";
import { Motion } from "../drawing/motion.js";
import { forgetSizes } from "../drawing/surface.js";
import { onThemeChange } from "../drawing/theme.js";
import { StateMap } from "../drawing/value_map.js";
import { count, counted, isWeighted, number } from "../format.js";
import { showInspection } from "./inspector.js";
import {
  along,
  bestContent,
  DIVERGED,
  learnedContent,
  pathOf,
  placeOn,
  showLegend,
  spokenResult,
  statusText,
  valueRange,
  visitsContent,
} from "./results.js";
import { PAINTED } from "../store.js";

const element = (id) => document.getElementById(id);
const FOLLOWED_PACE = 300; // steps a second
const WHEN_STOPPED = "Stop the training to see how much each action of a state is worth, and its last updates.";

/** Shows results: the last one of a run at once, and during training the newest one in each frame. */
export class View {
  constructor(store, announce, inspect) {
    Object.assign(this, { store, announce, inspect });
    this.result = null;
    this.episode = null;
    this.waiting = false;
    this.world = "";
    this.isStale = true;
    this.past = null;
    this.other = { result: null, episode: null, past: null, isStale: true };
    this.note = null;
    this.curve = new LearningCurve(element("curve"), element("curve-summary"));
    this.motion = new Motion({
      canvas: element("motion"),
      button: element("motion-play"),
      slider: element("motion-step"),
      caption: element("motion-caption"),
      onStep: (step) => this.showAgent(step),
    });
    const describe = (cell) => this.describe(cell);
    this.painter = new Painter(element("painter"), store, announce);
    this.values = new StateMap(element("values"), { name: "Map of the values", describe, onPick: (cell, how) => this.pick(cell, how) });
    this.visits = new StateMap(element("visits"), { name: "Map of the visits", describe });
    this.otherValues = new StateMap(element("other"), { name: "Map of the values of the other agent", describe });
    this.best = new StateMap(element("best"), { name: "Map of the optimum", describe });
    this.marks = new Marks(element("curve-key"));
    this.measure = null;
    this.markMeasure = radioButtons(element("measure"), "measure", [["returns", "Return"], ["lengths", "Steps"]], (measure) => {
      this.measure = measure;
      if (!this.isStale) this.showCurve(this.result);
    });
    showInspection(element("inspector-title"), element("inspection"), null);
    onThemeChange(() => this.isStale || this.draw());
  }

  /** Keeps the current view, but does not redraw it: it belongs to choices that have changed since. */
  expectAnother() {
    this.isStale = true;
    this.other.isStale = true;
    this.note = null;
  }

  /** Shows a result of the agent to compare with, or its values at an earlier time. */
  showOther(message) {
    if (!this.names.length) return;
    if (message.type === "past") this.other.past = message;
    else if (message.type === "result") {
      const episode = message.episode ?? this.other.episode;
      this.other = { result: message, episode, past: null, isStale: false };
    } else return;
    if (!this.isStale) this.drawSoon(message.state === "training");
  }

  /** Shows why the agent to compare with could not be trained, and the first agent alone. */
  showOtherProblem(message) {
    if (!this.names.length) return;
    this.other = { result: null, episode: null, past: null, isStale: false };
    this.note = `${this.names[1]} could not be trained to compare with: ${message}`;
    if (!this.isStale) this.draw();
  }

  /** The names of the agent and of the other one if two are compared. */
  get names() {
    const { state, otherSettings, definitions } = this.store;
    const title = (algorithm) => definitions.settings.algorithm.choices.find(({ value }) => value === algorithm).title;
    return otherSettings ? [title(state.settings.algorithm), title(state.compared)] : [];
  }

  /** The states of the run, and of that of the other agent if there is one. */
  get states() {
    return [this.result.state, this.otherResult?.state];
  }

  /** Shows the values as they were at an earlier time; null shows the newest ones. */
  showPast(message) {
    this.past = message;
    if (!message) this.other.past = null;
    if (!this.isStale) this.draw();
  }

  /** The newest result of the other agent; null if there is none, or it belongs to other choices. */
  get otherResult() {
    return this.names.length && !this.other.isStale ? this.other.result : null;
  }

  /** Shows a result, or only an inspection. */
  show(message) {
    if (message.type === "past") {
      this.showPast(message);
      return;
    }
    if (message.type === "inspection") {
      if (this.isStale) return;
      this.result.inspection = message.inspection;
      this.showState();
      return;
    }
    if (message.episode) this.episode = message.episode;
    else if (this.result && this.world !== this.worldOf()) this.episode = null;
    this.result = message;
    this.isStale = false;
    this.past = null;
    // Drawn once, with the other agent.
    if (this.names.length && this.other.isStale) return;
    this.drawSoon(message.state === "training");
  }

  /** Draws in the next frame during training, otherwise at once. */
  drawSoon(isTraining) {
    if (!isTraining) {
      this.draw();
      return;
    }
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      if (!this.isStale && this.states.includes("training")) this.draw();
    });
  }

  /** Shows a message above the results; null shows none. */
  showMessage(message) {
    const place = element("problem");
    place.hidden = message === null;
    // Setting the same text again would have it read aloud again.
    if (place.textContent !== (message ?? "")) place.textContent = message ?? "";
  }

  showProblem(message) {
    this.showMessage(message);
    element("status").textContent = "Not trained: see the message below.";
    element("stop").disabled = true;
    element("run").disabled = false;
  }

  /** Shows a message until another run begins. */
  showNote(message) {
    this.note = message;
    this.showMessage(message);
  }

  spoken(result) {
    return spokenResult(result, element("curve-summary").textContent, this.marks.of(this.store, result));
  }

  worldOf() {
    const { environment, grid } = this.store.state;
    return `${environment} ${JSON.stringify(grid)}`;
  }

  draw() {
    const { result } = this;
    this.showStatus(result);
    this.showCurve(result);
    this.showMotion(result);
    this.showMaps(result);
    this.showState();
  }

  /** The measure of the learning curve: "returns", or "lengths" for the numbers of steps. */
  get shownMeasure() {
    const { environment, grid } = this.store.state;
    // If steps cost nothing, their number shows how good the agent is.
    return this.measure ?? (environment === PAINTED && grid.step_reward === 0 ? "lengths" : "returns");
  }

  showCurve(result) {
    const { seeds, episodes } = result;
    const measure = this.shownMeasure;
    this.markMeasure(measure);
    const marks = measure === "returns" ? this.marks.of(this.store, result) : [];
    const bySeed = (of) => seeds.map((_, index) => of[measure].subarray(index * of.done, (index + 1) * of.done));
    const { names, otherResult } = this;
    this.marks.showKey(seeds.length, episodes, marks, measure === "returns" ? "return" : "number of steps", names);
    this.curve.show(bySeed(result), episodes, marks, measure, { names, others: otherResult && bySeed(otherResult) });
  }

  showStatus(result) {
    const { state, done, episodes } = result;
    element("status").textContent = statusText(result);
    element("progress").max = episodes;
    element("progress").value = done;
    const isTraining = this.states.includes("training");
    element("stop").disabled = !isTraining;
    element("run").textContent = this.states.includes("paused") ? (done ? "Continue" : "Run") : isTraining ? "Run" : "Run again";
    element("run").disabled = isTraining;
    this.showMessage(state === "diverged" ? DIVERGED : this.note);
  }

  showMotion(result) {
    const { environment, grid } = this.store.state;
    const { entry } = this.store;
    const world = this.worldOf();
    if (world !== this.world) {
      const painted = environment === PAINTED;
      const fixed = Object.values(entry.grids)[0];
      const { wind, rewards } = (painted ? grid : fixed) ?? { wind: null, rewards: null };
      this.motion.setWorld({ drawing: entry.drawing, layout: painted ? grid.layout : entry.layout, wind, rewards });
      this.world = world;
    }
    const inTraining = this.isInTraining(result);
    const [name] = this.names;
    const what = inTraining ? "agent in training" : "greedy agent in motion";
    element("motion-title").textContent = name ? `${name}: the ${what}` : `The ${what}`;
    if (inTraining) this.motion.showCurrent(result.current, this.currentText(result));
    else if (this.past?.episode) this.motion.show(this.past.episode, ` after ${counted(this.past.episodes, "episode")}`);
    else if (this.episode) this.motion.show(this.episode);
  }

  /** Whether to show the agent in its unfinished episode: between single steps, and at a speed that eyes can follow. */
  isInTraining({ state, current, pace }) {
    return current && !this.past && (state === "paused" || (state === "training" && pace <= FOLLOWED_PACE));
  }

  currentText({ current, done }) {
    const action = current.nextAction === null ? "" : `; next action: ${this.store.entry.actions[current.nextAction]}`;
    const so = current.step ? `, return so far ${number(current.episodeReturn)}` : "";
    return `Training, episode ${count(done + 1)}, after ${counted(current.step, "step")}${so}${action}. Training explores: it is not the greedy policy alone.`;
  }

  /** The plane, the layout and the names that all maps share. */
  frame() {
    const { environment, grid } = this.store.state;
    const { entry } = this.store;
    const layout = environment === PAINTED ? grid.layout : entry.layout;
    const rewards = environment === PAINTED ? grid.rewards : null;
    const { map: plane, actions } = entry;
    return { plane, layout, rewards, actions, drawing: entry.drawing };
  }

  showMaps(result) {
    const frame = this.frame();
    const { layout } = frame;
    const map = this.past?.map ?? result.map;
    if (layout && (layout.length !== map.rows || layout[0].length !== map.columns)) return;
    const other = this.otherResult;
    const isCompared = other !== null && other.map.columns === map.columns && other.map.rows === map.rows;
    const aspect = frame.plane ? 1.08 : map.columns / map.rows;
    const place = document.querySelector(".three");
    place.style.setProperty("--aspect", String(Math.min(Math.max(aspect, 0.6), 5)));
    place.classList.toggle("large-first", this.store.state.environment === PAINTED);
    place.classList.toggle("only-two", !result.best);
    place.classList.toggle("compared", isCompared);
    element("best-panel").hidden = !result.best;
    element("other-panel").hidden = !isCompared;
    forgetSizes();
    const inTraining = this.isInTraining(result);
    const path = inTraining ? null : pathOf(this.past?.episode ?? this.episode, frame);
    // The newest maps decide on the colors, so that looking back does not change them.
    const range = valueRange([result.map, ...(isCompared ? [other.map] : [])], result.best, layout);
    this.values.show(learnedContent(map, range, frame, path));
    const visits = visitsContent(map, frame);
    this.visits.show(visits);
    const [low, high] = range.map((value) => number(value, 3));
    showLegend(element("values-legend"), "values", low, high, true);
    showLegend(element("visits-legend"), visits.palette, "0", count(visits.most));
    element("values-title").textContent = isCompared ? `What ${this.names[0]} learned` : "What it learned";
    element("visits-title").textContent = isCompared ? `Where ${this.names[0]} has been` : "Where it has been";
    if (isCompared) this.showOtherMap(frame, range, [low, high], inTraining);
    this.showBest(result, range, frame, low, high);
    if (inTraining) this.values.showAgent(this.placeOf(result.current.observation, result.current.cell));
  }

  showOtherMap(frame, range, limits, inTraining) {
    const { result, episode: newest, past } = this.other;
    const episode = past?.episode ?? newest;
    this.otherValues.show(learnedContent(past?.map ?? result.map, range, frame, inTraining ? null : pathOf(episode, frame)));
    showLegend(element("other-legend"), "values", ...limits, true);
    element("other-title").textContent = `What ${this.names[1]} learned`;
    const when = past ? ` after ${counted(past.episodes, "episode")}` : "";
    element("other-caption").textContent = `The same settings but for the algorithm, in the same colors. ${episode ? this.motion.words(episode, when) : ""}`;
  }

  showBest(result, range, frame, low, high) {
    const { best } = result;
    const { entry, state } = this.store;
    const { discount } = state.settings;
    element("best-title").textContent = best?.kind === "optimal" ? "The optimum" : "The best known";
    if (!best) return;
    this.best.show(bestContent(result, range, frame));
    showLegend(element("best-legend"), "values", low, high);
    const word = best.kind === "optimal" ? "optimal" : "best known";
    const value = bestReturn(entry, state.settings, best);
    // The return is not discounted: with γ < 1 the policy shown may differ from the one that earns it.
    const subject = best.kind === "optimal" && discount < 1 ? "The greatest expected return, without discounting," : "Its expected return";
    const expected = value === null ? "" : ` ${subject} is ${number(value)}.`;
    element("best-caption").textContent = `The ${word} values for γ = ${number(discount)} and an ${word} policy, in the same colors.${expected}`.replace("an best", "the best");
  }

  placeOf(observation, cell) {
    const { plane } = this.values.content;
    return plane ? placeOn(plane, observation) : cell;
  }

  showAgent(step) {
    if (this.isStale || !this.values.content) return;
    const { observations, components, cells } = this.motion.episode;
    const at = Math.min(step, cells.length - 1);
    const place = this.placeOf(observations.subarray(at * components, (at + 1) * components), cells[at]);
    if (JSON.stringify(place) !== JSON.stringify(this.values.agent)) this.values.showAgent(place);
  }

  /** A cell in words, for screen readers. */
  describe(cell) {
    if (this.isStale) return "no result yet";
    const map = this.past?.map ?? this.result.map;
    const { layout, actions } = this.frame();
    const [row, column] = [Math.floor(cell / map.columns), cell % map.columns];
    if (layout?.[row][column] === " ") return "No state.";
    const words = stateWords(this.store.entry.drawing, cell, map.columns);
    const place = words[0].toUpperCase() + words.slice(1);
    if (Number.isNaN(map.values[cell])) return `${place}: wall.`;
    const kind = { S: ", start", G: ", goal", H: ", hole", C: ", cliff" }[layout?.[row]?.[column]] ?? "";
    const greedy = actions[map.greedy[cell]];
    const policy = greedy ? `, greedy action ${greedy}` : "";
    return `${place}${kind}: value ${number(map.values[cell])}${policy}, visited ${counted(Math.round(map.visits[cell]), "time")}.`;
  }

  /**
   * The state of an inspected cell in words: its observation, with angles for their cosines and sines, or its number, which
   * is its row in Python's table, and its position on the grid.
   */
  stateText({ cell, observation }) {
    const { observations, drawing, map } = this.store.entry;
    if (!observations) return `State ${observation[0]}: ${stateWords(drawing, cell, this.result.map.columns)}`;
    const angles = [map.x, map.y].filter((axis) => axis.is_angle);
    const isSine = (index) => angles.some(({ component }) => component + 1 === index);
    const axes = observations.map((each, component) => angles.find((angle) => angle.component === component) ?? { ...each, component });
    const text = (axis) => `${axis.name} ${number(Number(along(axis, observation).toFixed(6)), 3)}${axis.unit ? ` ${axis.unit}` : ""}`;
    return `State: ${axes.filter((_, index) => !isSine(index)).map(text).join(", ")}`;
  }

  pick(cell, how) {
    if (this.painter.isPainting) {
      this.painter.paint(cell, how);
      return;
    }
    if (how === "drag") return;
    if (!this.isStale && Number.isNaN(this.result.map.values[cell])) {
      // A wall, or a gap of the map, has no numbers.
      this.announce(this.describe(cell));
      return;
    }
    this.values.select(cell);
    this.inspect(cell);
    if (how === "key") this.announce(`Selected. ${this.describe(cell)} Its numbers are below the maps.`);
  }

  showState() {
    const { inspection, state, pace } = this.result;
    if (!inspection && state === "training") {
      // A slow run would keep the numbers of an earlier one for long.
      if (pace !== Infinity) showInspection(element("inspector-title"), element("inspection"), null, null, null, WHEN_STOPPED);
      return;
    }
    if (this.values.selected !== (inspection?.cell ?? null) && inspection) this.values.select(inspection.cell);
    const { actions } = this.store.entry;
    const bootstraps = this.store.definitions.bootstraps[this.store.state.settings.algorithm];
    const when = this.past ? ", at the end of the training" : "";
    const weighted = isWeighted(this.store.state.settings);
    const updates = inspection?.updates.map((update) => ({ ...update, isWeighted: weighted }));
    const named = inspection && { ...inspection, updates, state: `${this.stateText(inspection)}${when}` };
    showInspection(element("inspector-title"), element("inspection"), named, actions, bootstraps);
  }
}
