// A selected state: its action values and visits, and its last updates as equations with their numbers.

import { make } from "../controls/elements.js";
import { count, distinguished, number, term } from "../format.js";

const DIGITS = 5;
const SUBSCRIPTS = ["₁", "₂"];

/** The name of the updated value: Double Q-learning has two tables. */
function nameOf(table, bootstraps) {
  return `Q${bootstraps.length > 1 ? SUBSCRIPTS[table] : ""}(S, A)`;
}

/**
 * The equation of updates in symbols. `bootstraps`: the term for the value of the next state, one text for each table
 * that the algorithm learns: Double Q-learning has two.
 */
function symbolEquation({ kind, table, learningRate, isWeighted }, bootstraps) {
  const value = nameOf(table, bootstraps);
  const source = kind === "planning" ? "Planning with the model: " : "";
  if (learningRate === null) return `${source}${value} ← R`;
  const following = bootstraps[table].replaceAll("'", "′").replaceAll("Q1", "Q₁").replaceAll("Q2", "Q₂");
  const rate = isWeighted ? "Σ αᵢ xᵢ²" : "α";
  const target = { n_step: "G", planning: "target" }[kind] ?? `R + γ ${following}`;
  if (kind === "dutch_trace") return `${value} ← ${value} + ${rate} z [${target} − Q_old] − ${rate} [${value} − Q_old]`;
  return `${source}${value} ← ${value} + ${rate} ${kind === "trace" ? "z " : ""}[${target} − ${value}]`;
}

/** The equation with the numbers of an update, as parts: the last one is the new value. */
function numberEquation(update, bootstraps) {
  const { kind, table, learningRate, trace, qOld } = update;
  const after = number(update.new ?? NaN, DIGITS);
  if (learningRate === null) return [`${nameOf(table, bootstraps)} ← `, after];
  const [old, rate, target] = [update.old ?? NaN, number(learningRate, DIGITS), targetNumbers(update)];
  const before = number(old, DIGITS);
  if (kind === "dutch_trace") {
    const seen = term(qOld ?? NaN, DIGITS);
    return [`${before} + ${rate} · ${term(trace, DIGITS)} · [${target} − ${seen}] − ${rate} · [${before} − ${seen}] = `, after];
  }
  const share = kind === "trace" ? `${rate} · ${term(trace, DIGITS)}` : rate;
  return [`${before} + ${share} · [${target} − ${term(old, DIGITS)}] = `, after];
}

function targetNumbers({ kind, reward, nextValue, discount, target }) {
  if (kind === "n_step" || kind === "planning") return number(target ?? NaN, DIGITS);
  if (nextValue === null) return number(reward, DIGITS);
  return `${number(reward, DIGITS)} + ${number(discount, DIGITS)} · ${term(nextValue, DIGITS)}`;
}

const SHOWN_UPDATES = 5;
const HINT =
  "Select a cell of the first map, with the pointer or with the arrow keys and Enter. Here you then see how much each " +
  "action is worth, how often it was taken, and the last updates with their numbers.";
const WEIGHTED =
  "Each update of a state in this cell moves all weights of the action at once: weight i by αᵢ xᵢ times the error, and so the " +
  "value by Σ αᵢ xᵢ² times the error.";
const WEIGHTED_TRACES =
  "Each update moves all weights at once, in proportion to their traces zᵢ. Here z is a mean of those of the action: Σ αᵢ zᵢ xᵢ " +
  "divided by Σ αᵢ xᵢ².";
const BETWEEN = " Between these updates, those of other states move the value as well.";
const UNVISITED = "No update yet: the agent has not left this state by a step.";
const ENDS = {
  terminal: "a terminal state follows",
  truncated: "the time limit ends the episode",
  truncated_as_terminal: "the time limit ends the episode, and the next state counts as terminal",
};

/** Shows an inspection below a title; null shows a hint, such as how to select a state. */
export function showInspection(title, place, inspection, actions, bootstraps, hint = HINT) {
  if (!inspection) {
    title.textContent = "A state and its numbers";
    place.replaceChildren(make("p", { className: "hint", textContent: hint }));
    return;
  }
  title.textContent = inspection.state;
  const values = make("div", {}, make("h4", { textContent: bootstraps.length > 1 ? "Action values Q(s, a), averaged over both tables, and visits" : "Action values Q(s, a) and visits" }), valueTable(inspection, actions));
  const updates = make("div", {}, make("h4", { textContent: "Last updates, newest first" }));
  const newest = [...inspection.updates].reverse().slice(0, SHOWN_UPDATES);
  if (newest.length) {
    updates.append(make("p", { className: "equation symbols", textContent: symbolEquation(newest[0], bootstraps) }));
    updates.append(make("ol", { className: "updates" }, ...newest.map((update) => updateItem(update, actions, newest[0], bootstraps))));
    if (newest[0].isWeighted) {
      const text = newest[0].kind.endsWith("trace") ? WEIGHTED_TRACES : WEIGHTED;
      updates.append(make("p", { className: "hint", textContent: text + BETWEEN }));
    }
  } else {
    updates.append(make("p", { className: "hint", textContent: UNVISITED }));
  }
  place.replaceChildren(make("div", { className: "inspected" }, values, updates));
}

function valueTable({ actionValues, visits }, actions) {
  const [lowest, largest] = [Math.min(...actionValues), Math.max(...actionValues)];
  const head = make("tr", {}, ...["Action", "Value", "Visits", "Above worst"].map((textContent) => make("th", { scope: "col", textContent })));
  const texts = distinguished(actionValues);
  const rows = actions.map((action, index) => {
    const bar = make("span", { className: "bar" });
    // From the worst action's value, so that the greedy action has the longest bar even if all values are negative.
    const share = (actionValues[index] - lowest) / (largest - lowest);
    bar.style.width = `${Number.isFinite(share) ? 100 * share : 0}%`;
    const name = make("th", { scope: "row", textContent: action });
    const cells = [texts[index], count(Math.round(visits[index]))].map((text) => make("td", { textContent: text }));
    const row = make("tr", {}, name, ...cells, make("td", { className: "bar-cell" }, bar));
    if (actionValues[index] === largest) row.className = "greedy";
    return row;
  });
  return make("table", { className: "action-values" }, make("thead", {}, head), make("tbody", {}, ...rows));
}

function updateItem(update, actions, first, bootstraps) {
  const end = ENDS[update.end];
  const reward = update.reward === null ? "" : `, reward ${number(update.reward)}`;
  // The action of a delayed or planned update is not that of the step during which it is made.
  const time = update.end === "other" ? "after step" : "step";
  const when = `Episode ${count(update.episode + 1)}, ${time} ${count(update.step + 1)}: ${actions[update.action]}${reward}`;
  const parts = numberEquation(update, bootstraps);
  const equation = make("p", { className: "equation" }, parts[0], make("b", { textContent: parts[1] }));
  const item = make("li", {}, make("p", { className: "when", textContent: end ? `${when}; ${end}` : when }));
  const symbols = symbolEquation(update, bootstraps);
  if (symbols !== symbolEquation(first, bootstraps)) item.append(make("p", { className: "equation symbols", textContent: symbols }));
  item.append(equation);
  return item;
}
