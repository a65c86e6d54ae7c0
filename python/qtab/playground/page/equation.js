// An update as an equation: in symbols, and with the numbers that the learner used.

import { number, term } from "./format.js";

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
export function symbolEquation({ kind, table, learningRate }, bootstraps) {
  const value = nameOf(table, bootstraps);
  const source = kind === "planning" ? "Planning with the model: " : "";
  if (learningRate === null) return `${source}${value} ← R`;
  const following = bootstraps[table].replaceAll("'", "′").replaceAll("Q1", "Q₁").replaceAll("Q2", "Q₂");
  const target = { n_step: "G", planning: "target" }[kind] ?? `R + γ ${following}`;
  if (kind === "dutch_trace") return `${value} ← ${value} + α z [${target} − Q_old] − α [${value} − Q_old]`;
  return `${source}${value} ← ${value} + α ${kind === "trace" ? "z " : ""}[${target} − ${value}]`;
}

/** The equation with the numbers of an update, as parts: the last one is the new value. */
export function numberEquation(update, bootstraps) {
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
