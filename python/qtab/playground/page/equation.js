// An update as an equation: in symbols, and with its numbers.

import { number, term } from "./format.js";

const DIGITS = 5;

/**
 * The equation of updates in symbols. `bootstraps`: how the target takes the value of the next state, one text for each
 * table that the algorithm learns: Double Q-learning has two.
 */
export function symbolEquation({ kind, table }, bootstraps) {
  const value = `Q${bootstraps.length > 1 ? "₁₂"[table] : ""}(S, A)`;
  if (kind === "assign") return `${value} ← R`;
  if (kind === "planning") return `Planning with the model: ${value} ← ${value} + α [target − ${value}]`;
  if (kind === "n_step") return `${value} ← ${value} + α [G − ${value}]`;
  const following = bootstraps[table].replaceAll("'", "′").replaceAll("Q1", "Q₁").replaceAll("Q2", "Q₂");
  return `${value} ← ${value} + α ${kind === "trace" ? "z " : ""}[R + γ ${following} − ${value}]`;
}

/** The same with the numbers of an update, as parts: the last one is the new value. */
export function numberEquation(update) {
  const { kind, old, target, learningRate } = update;
  const after = number(update.new, DIGITS);
  const before = number(old, DIGITS);
  if (kind === "assign") return ["Q(S, A) ← ", after];
  if (target === null) return [`Q(S, A) from ${before} to `, after];
  const error = `${targetNumbers(update)} − ${term(old, DIGITS)}`;
  if (kind === "trace") return [`δ = ${error} = ${number(target - old, DIGITS)}, and Q(S, A) from ${before} to `, after];
  return [`${before} + ${number(learningRate, DIGITS)} · [${error}] = `, after];
}

function targetNumbers({ kind, next, reward, nextValue, discount, target }) {
  if (kind === "n_step" || kind === "planning") return number(target, DIGITS);
  if (nextValue === null || next === "terminal") return number(reward, DIGITS);
  return `${number(reward, DIGITS)} + ${number(discount, DIGITS)} · ${term(nextValue, DIGITS)}`;
}
